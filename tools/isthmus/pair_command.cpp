// isthmus pair: how does one scan fit onto another?
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/disk_space.h"
#include "commands.h"
#include "exit_codes.h"
#include "io/scan_directory.h"
#include "pairwise/judge.h"
#include "pipelines/pair_pipeline.h"
#include "report/survey_record.h"
#include "settings_flags.h"
#include "store/store.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

template <class M>
Json rows_of(const M& matrix) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(row);
  }
  return rows;
}

Json object_of(const std::vector<std::pair<std::string, double>>& values) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object[name] = value;
  return object;
}

Json seconds_of(const pipelines::PairAnswer& answer) {
  Json seconds = Json::object();
  const auto add = [&](const std::string& scan, const std::vector<pipelines::StageTime>& times) {
    for (const pipelines::StageTime& time : times) seconds[scan + "_" + time.stage] = time.seconds;
  };
  add("source", answer.source_times);
  add("target", answer.target_times);
  for (const auto& [stage, value] : answer.result.seconds_by_stage) seconds[stage] = value;
  return seconds;
}

/// The terms behind a verdict, null where nothing was weighed: their names do not depend on what became of the pair.
Json evidence_of(const PairResult& result) {
  PairResult unweighed;
  judge({}, {}, unweighed);
  Json evidence = Json::object();
  for (const auto& [name, value] : unweighed.evidence) evidence[name] = nullptr;
  for (const auto& [name, value] : result.evidence) evidence[name] = value;
  return evidence;
}

/// Every key, always; what was not measured is null.
Json json_of(const pipelines::PairAnswer& answer) {
  const PairResult& result = answer.result;
  const bool posed = answer.target_from_source_in_scans.has_value();
  const auto measured = [&](double value) { return posed ? Json(value) : Json(); };
  Json json;
  json["verdict"] = report::word(result.verdict);
  json["reason"] = result.reason;
  json["probability"] = result.probability;
  json["overlap"] = measured(result.overlap);
  json["overlap_of_source"] = measured(result.overlap_of_source);
  json["overlap_of_target"] = measured(result.overlap_of_target);
  json["rms_m"] = measured(result.rms_m);
  json["voxel_m"] = answer.voxel_m > 0 ? Json(answer.voxel_m) : Json();
  json["transform"] = posed ? rows_of(answer.target_from_source_in_scans->matrix()) : Json();
  json["information"] = posed ? rows_of(answer.information_in_scans) : Json();
  json["evidence"] = evidence_of(result);
  json["counts"] = object_of(result.counts);
  json["from_store"] = answer.from_store;
  json["seconds"] = seconds_of(answer);
  return json;
}

void print_json(const pipelines::PairAnswer& answer) {
  // Replacing broken UTF-8 (file names may hold any byte) keeps it one object.
  fmt::print("{}\n", json_of(answer).dump(2, ' ', false, Json::error_handler_t::replace));
}

std::string matrix_text(const Transform& target_from_source) {
  std::string text;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) text += fmt::format("{}{:.17g}", c == 0 ? "" : " ", target_from_source(r, c));
    text += "\n";
  }
  return text;
}

/// Whether two names lead to one file.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error);
}

struct PairRun {
  std::string source;
  std::string target;
  std::string output;
  SettingsFlags flags;

  int run() const {
    Terminal terminal;
    pipelines::Settings settings;
    if (const Result<void> good = flags.apply(settings); !good) {
      terminal.error(good.error());
      return kUsage;
    }
    if (!output.empty() && (same_file(output, source) || same_file(output, target))) {
      terminal.error({"the output is one of the scans", output, "name another file with -o"});
      return kUsage;
    }
    Result<pipelines::PairAnswer> answer = clear_output().and_then([&] { return pair_of_files(settings, terminal); });
    if (!answer) {
      terminal.error(answer.error());
      pipelines::PairAnswer failed;
      failed.result.reason = answer.error().text();
      print_json(failed);
      return kFailure;
    }
    print_json(*answer);
    if (!output.empty() && answer->target_from_source_in_scans) {
      const Result<void> written = write_file_atomically(output, matrix_text(*answer->target_from_source_in_scans));
      if (!written) {
        terminal.error(written.error());
        return kFailure;
      }
    }
    return answer->result.verdict == Verdict::accepted ? kSuccess : kUnconnected;
  }

  /// A matrix of an earlier run must not pass for this one's, whatever becomes of this one.
  Result<void> clear_output() const {
    if (output.empty()) return {};
    std::error_code error;
    if (fs::is_directory(output, error)) return fail("is a folder, a file is wanted", output, "name a file with -o");
    fs::remove(output, error);
    if (error) return tl::unexpected(write_error("the earlier file cannot be removed", error.value(), output));
    const fs::path folder = fs::absolute(output, error).parent_path();
    if (::access(folder.c_str(), W_OK) != 0) {
      return tl::unexpected(write_error("the output cannot be written", errno, output));
    }
    return {};
  }

  Result<pipelines::PairAnswer> pair_of_files(const pipelines::Settings& settings, Terminal& terminal) const {
    const Result<io::ScanRef> source_scan = io::resolve_scan_name(source);
    if (!source_scan) return tl::unexpected(source_scan.error());
    const Result<io::ScanRef> target_scan = io::resolve_scan_name(target);
    if (!target_scan) return tl::unexpected(target_scan.error());
    const std::string& folder = settings.run.store;
    const Result<store::Store> store =
        folder.empty() ? store::Store::none()
                       : store::Store::open(folder, [&](const Error& damage) { terminal.warn(damage.text()); });
    if (!store) return tl::unexpected(store.error());
    return pipelines::run_pair(*source_scan, *target_scan, settings, *store, terminal.events());
  }
};

}  // namespace

void add_pair(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("pair", "Register one scan to another; prints one JSON object");
  auto run = std::make_shared<PairRun>();
  command->add_option("SOURCE", run->source, "The scan that moves: a file, or file#k for the k-th scan of a file")
      ->required();
  command->add_option("TARGET", run->target, "The scan that stays")->required();
  command
      ->add_option("-o,--output", run->output, "File for the 4x4 matrix target_from_source, in the files' coordinates")
      ->type_name("FILE");
  run->flags.add_config(*command);
  run->flags.add_overrides(*command);
  run->flags.add_store(*command);
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
