// isthmus export: the poses of a finished survey, and its scans with their poses, for other programs.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "commands.h"
#include "exit_codes.h"
#include "io/scan_directory.h"
#include "io/wording.h"
#include "pipelines/e57_export.h"
#include "report/pose_exports.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

namespace fs = std::filesystem;

/// The folder the scans were read from, by run.json.
Result<fs::path> input_folder(const fs::path& out) {
  const fs::path path = out / "run.json";
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  const nlohmann::json* input = nullptr;
  if (json.is_object() && json.contains("run") && json["run"].contains("input")) input = &json["run"]["input"];
  std::error_code error;
  if (input != nullptr && input->is_string() && fs::is_directory(input->get<std::string>(), error)) {
    return fs::path(input->get<std::string>());
  }
  return fail("the folder of the scans is not named there, or is gone", path.string(), "name it: --scans DIR");
}

struct ExportRun {
  std::string out;
  std::string poses;
  std::string file;
  std::string e57;
  std::string scans;
  int component = 0;

  int run() const {
    Terminal terminal;
    const auto survey = report::read_finished_survey(out);
    const Result<void> done = survey ? export_all(*survey, terminal) : tl::unexpected(survey.error());
    if (done) return kSuccess;
    terminal.error(done.error());
    return kFailure;
  }

 private:
  Result<void> export_all(const report::FinishedSurvey& survey, Terminal& terminal) const {
    if (component >= survey.num_components()) {
      return fail(fmt::format("the survey has {} components, there is no {}", survey.num_components(), component), out,
                  "components are counted from 0, the largest");
    }
    std::size_t elsewhere = 0;
    for (const report::FinishedScan& scan : survey.scans) elsewhere += scan.component != component ? 1 : 0;
    if (elsewhere > 0) {
      terminal.warn(
          fmt::format("{} scans in other components have another frame and are left out (--component K)", elsewhere));
    }
    if (auto written = poses.empty() ? Result<void>() : write_poses(survey); !written) return written;
    return e57.empty() ? Result<void>() : write_e57(survey, terminal);
  }

  Result<void> write_poses(const report::FinishedSurvey& survey) const {
    const std::string text = report::export_poses(survey, component, *report::pose_format(poses));
    if (!file.empty()) return write_file_atomically(file, text);
    fmt::print("{}", text);
    return {};
  }

  Result<void> write_e57(const report::FinishedSurvey& survey, Terminal& terminal) const {
    const Result<fs::path> base = scans.empty() ? input_folder(out) : Result<fs::path>(fs::path(scans));
    if (!base) return tl::unexpected(base.error());
    std::vector<pipelines::PlacedScan> placed;
    for (const report::FinishedScan& scan : survey.scans) {
      if (scan.component != component) continue;
      Result<io::ScanRef> ref = io::resolve_scan_name((*base / scan.name).string());
      if (!ref) return tl::unexpected(std::move(ref.error()));
      ref->name = scan.name;
      placed.push_back({std::move(*ref), scan.component_from_scan});
    }
    if (io::lower_case(fs::path(e57).extension().string()) == ".e57") {
      auto written = pipelines::export_e57_file(e57, placed);
      if (written) terminal.say(fmt::format("{} scans in {}", placed.size(), e57));
      return written;
    }
    const auto written = pipelines::export_e57_folder(e57, *base, placed);
    if (!written) return tl::unexpected(written.error());
    terminal.say(fmt::format("{} scans in {} files in {}", placed.size(), written->size(), e57));
    return {};
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("export", "Write a finished survey's poses or scans for other programs");
  auto run = std::make_shared<ExportRun>();
  command->add_option("OUT", run->out, "Output folder of 'register'")->required();
  CLI::Option* poses =
      command->add_option("--poses", run->poses, "Poses as open3d (PoseGraph JSON, with the links), tum, kitti or csv")
          ->type_name("FORMAT")
          ->check(CLI::IsMember({"open3d", "tum", "kitti", "csv"}));
  command->add_option("-o,--output", run->file, "File for the poses (default: standard output)")
      ->type_name("FILE")
      ->needs(poses);
  CLI::Option* e57 = command
                         ->add_option("--e57", run->e57,
                                      "Scans with their poses as E57: all in FILE.e57, or one file each in a folder")
                         ->type_name("PATH");
  command->add_option("--scans", run->scans, "Folder of the scans (default: by OUT/run.json)")
      ->type_name("DIR")
      ->needs(e57);
  command->add_option("--component", run->component, "Which component (default: 0, the largest)")
      ->type_name("K")
      ->check(CLI::NonNegativeNumber);
  command->callback([run, &exit_code] {
    if (run->poses.empty() && run->e57.empty()) throw CLI::RequiredError("--poses or --e57");
    exit_code = run->run();
  });
}

}  // namespace isthmus::cli
