#include "pipelines/solve_again.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "config/yaml.h"
#include "io/text_number.h"
#include "pipelines/control_file.h"
#include "pipelines/output_folder.h"
#include "pipelines/run_facts.h"
#include "pipelines/survey_record.h"
#include "pipelines/view_clouds.h"
#include "report/write_outputs.h"
#include "survey/hand_links.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

// Matrices are printed with six digits or more.
constexpr double kRotationTolerance = 1e-4;

/// What run.json says that solving again needs.
struct Digests {
  std::string measured, edited, settings_yaml;
};

Result<Digests> digests_in(const fs::path& out) {
  const fs::path path = out / "run.json";
  std::error_code error;
  if (!fs::is_directory(out, error)) {
    return fail("there is no such folder", out.string(), "name the output folder of a finished 'isthmus register'");
  }
  if (!fs::exists(path, error)) {
    return fail("no finished survey: run.json is missing", out.string(),
                "run 'isthmus register' with -o on this folder; what is in its store is not made again");
  }
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  const auto word = [&](const nlohmann::json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_string() ? object[key].get<std::string>()
                                                                                 : std::string();
  };
  if (!json.is_object() || !json.contains("run") || word(json["run"], "survey").empty()) {
    return fail("it does not name the measured survey in the store", path.string(),
                "run the same 'isthmus register' again; its products are found in the store");
  }
  const std::string edited = word(json["run"], "edited_survey"), measured = word(json["run"], "survey");
  return Digests{measured, edited.empty() ? measured : edited, word(json, "settings")};
}

/// A 3x4 or 4x4 matrix, row by row.
Result<Transform> read_matrix(const fs::path& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  const std::string where = path.string();
  const std::string hint = "give 3 or 4 lines of 4 numbers, as 'isthmus pair -o' writes them";
  std::string line = *text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::vector<double> v;
  for (const std::string_view word : io::words_of(line)) {
    const auto number = io::whole_number<double>(word);
    if (!number || !std::isfinite(*number)) {
      return fail(fmt::format("'{}' is not a finite number", word), where, hint);
    }
    v.push_back(*number);
  }
  if (v.size() != 12 && v.size() != 16)
    return fail(fmt::format("{} numbers, 12 or 16 are wanted", v.size()), where, hint);
  if (v.size() == 16 && (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1)) {
    return fail(fmt::format("the last row is {} {} {} {}, not 0 0 0 1", v[12], v[13], v[14], v[15]), where,
                "write the matrix row by row");
  }
  Transform t = Transform::Identity();
  for (std::size_t k = 0; k < 12; ++k) t.matrix()(static_cast<int>(k / 4), static_cast<int>(k % 4)) = v[k];
  const Eigen::Matrix3d rotation = t.linear();
  const double determinant = rotation.determinant();
  const double skewness = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (determinant > 0 && skewness <= kRotationTolerance) return orthonormalised(t);
  return fail(fmt::format("not a rigid transform: its rotation part is {:.2g} off orthonormal, determinant {:.6g}",
                          skewness, determinant),
              where,
              determinant > 0 ? "take out scale and shear; a scale of units belongs into the scan's file"
                              : "it mirrors; swap no axes");
}

Result<int> scan_in_graph(const MeasuredSurvey& measured, const std::string& name) {
  const Result<int> id = scan_id_of(measured, name);
  if (!id) return id;
  const bool used = std::any_of(measured.graph.scans.begin(), measured.graph.scans.end(),
                                [&](const GraphScan& scan) { return scan.id == *id; });
  if (used) return id;
  const report::ScanRecord& scan = measured.scans[static_cast<std::size_t>(*id)];
  return fail(fmt::format("{} takes no part: {}", scan.name, scan.reason));
}

Result<void> take_out(const LinkToTakeOut& edit, MeasuredSurvey& measured) {
  const Result<int> a = scan_in_graph(measured, edit.a), b = scan_in_graph(measured, edit.b);
  const std::string where = fmt::format("--without-link {} {}", edit.a, edit.b);
  for (const Result<int>* id : {&a, &b}) {
    if (!*id) return fail(id->error().what, where, id->error().hint);
  }
  if (take_out_links(measured.graph, *a, *b) > 0) return {};
  return fail("the pair was not tried, there is no link to take out", where,
              "the pairs that were tried are in links.csv");
}

Result<void> add(const LinkToAdd& edit, MeasuredSurvey& measured) {
  const Result<int> source = scan_in_graph(measured, edit.source), target = scan_in_graph(measured, edit.target);
  const std::string where = fmt::format("--add-link {} {}", edit.source, edit.target);
  for (const Result<int>* id : {&source, &target}) {
    if (!*id) return fail(id->error().what, where, id->error().hint);
  }
  if (*source == *target) return fail("a link joins two scans", where);
  const Result<Transform> in_scans = read_matrix(edit.matrix);
  if (!in_scans) return tl::unexpected(in_scans.error());
  const auto origin = [&](int id) { return measured.scans[static_cast<std::size_t>(id)].local_origin_in_scan; };
  const Transform local = Eigen::Translation3d(-origin(*target)) * *in_scans * Eigen::Translation3d(origin(*source));
  measured.graph.links.push_back(link_by_hand(measured.graph, *source, *target, local));
  return {};
}

Result<void> apply_solve_settings(const std::vector<std::string>& assignments, Settings& settings) {
  for (const std::string& assignment : assignments) {
    if (assignment.starts_with("solve.")) continue;
    return fail(fmt::format("'{}' cannot be changed here, only settings of 'solve'", assignment), "--set",
                "run 'isthmus register' again; what is in its store is not made again");
  }
  return apply_assignments(settings, assignments);
}

}  // namespace

Result<FinishedRun> load_finished_run(const fs::path& out, const Events& events) {
  FinishedRun run;
  const Result<Digests> digests = digests_in(out);
  if (!digests) return tl::unexpected(digests.error());
  run.measured_digest = digests->measured;
  run.settings_yaml = digests->settings_yaml;
  Result<std::vector<Job>> jobs = read_jobs(out / "resolved.yaml");
  if (!jobs) return tl::unexpected(jobs.error());
  if (jobs->size() != 1) return fail("one job is wanted here", (out / "resolved.yaml").string());
  run.job = std::move(jobs->front());
  run.job.output = out;
  const fs::path folder = store_folder(run.job);
  const std::string hint = "run the same 'isthmus register' again";
  std::error_code error;
  if (!fs::is_directory(folder, error)) return fail("the store of the survey is gone", folder.string(), hint);
  const Result<store::Store> store =
      store::Store::open(folder, [&](const Error& trouble) { events.warn(trouble.text()); });
  if (!store) return tl::unexpected(store.error());
  std::optional<MeasuredSurvey> measured = load_measured(digests->measured, *store);
  if (!measured)
    return fail("the store no longer holds the measured survey " + digests->measured, folder.string(), hint);
  run.measured = std::move(*measured);
  std::optional<MeasuredSurvey> edited = load_measured(digests->edited, *store);
  run.edited = edited ? std::move(*edited) : run.measured;
  return run;
}

Result<void> apply_edits(const SolveEdits& edits, MeasuredSurvey& measured) {
  for (const LinkToTakeOut& edit : edits.take_out) {
    if (const Result<void> done = take_out(edit, measured); !done) return done;
  }
  for (const LinkToAdd& edit : edits.add) {
    if (const Result<void> done = add(edit, measured); !done) return done;
  }
  return {};
}

Result<JobResult> solve_again(const fs::path& out, const SolveEdits& edits, const std::string& command,
                              const Events& events) {
  const auto start = std::chrono::steady_clock::now();
  report::RunRecord run = begun_run(command);
  Result<FinishedRun> finished = load_finished_run(out, events);
  if (!finished) return tl::unexpected(finished.error());
  Result<OutputFolder> output = OutputFolder::open(out);
  if (!output) return tl::unexpected(output.error());
  Job& job = finished->job;
  if (Result<void> done = apply_solve_settings(edits.assignments, job.settings); !done) {
    return tl::unexpected(done.error());
  }
  if (Result<void> done = apply_edits(edits, finished->measured); !done) return tl::unexpected(done.error());
  if (!edits.control.empty()) job.control = edits.control;
  Control control;
  if (!job.control.empty()) {
    const auto items = read_control(job.control);
    if (!items) return tl::unexpected(items.error());
    Result<Control> found = control_of(*items, finished->measured);
    if (!found) return tl::unexpected(found.error());
    control = std::move(*found);
  }

  JobResult result;
  result.record = record_of(job, finished->measured, solve(finished->measured.graph, job.settings.solve, control));
  const Result<store::Store> store = store::Store::open(store_folder(job), [&](Error trouble) {
    trouble.hint = "'isthmus register' makes it anew";
    events.warn(trouble.text());
  });
  if (!store) return tl::unexpected(store.error());
  if (output->reserve(bytes_of_view(result.record.scans.size())))
    add_view_clouds(finished->measured.view_keys, *store, events, result.record);
  else
    go_without_view(kNoSpaceForView, events, result.record);
  complete_warnings(result.record, events);
  result.end = end_of(result.record);
  run.input = text_of_inputs(job);
  run.output = out.string();
  run.store = store_folder(job).string();
  run.threads = 1;
  run.more = {{"survey", finished->measured_digest}};
  if (!edits.take_out.empty() || !edits.add.empty()) {
    run.more.emplace_back("edited_survey", keep_measured(finished->measured, *store));
  }
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.peak_memory_bytes = peak_memory_bytes();
  run.exit_code = result.end == JobEnd::connected ? 0 : 3;
  result.record.run = run;
  std::error_code ignored;
  fs::remove(out / "run.json", ignored);  // the mark of completeness
  output->give_back();
  if (const Result<void> written = report::write_outputs(result.record, out); !written) {
    return tl::unexpected(written.error());
  }
  return result;
}

Result<report::SurveyRecord> record_as_solved(FinishedRun finished) {
  const std::string file = (finished.job.output / "run.json").string();
  if (!finished.settings_yaml.empty()) {
    const Result<YAML::Node> node = config::parse_yaml(finished.settings_yaml, file);
    if (!node) return tl::unexpected(node.error());
    std::vector<config::Stage> stages = finished.job.settings.stages();
    const Result<void> done = config::apply_yaml(*node, stages, file, finished.job.settings.origins);
    if (!done) return tl::unexpected(done.error());
  }
  return record_of(finished.job, finished.edited, solve(finished.edited.graph, finished.job.settings.solve));
}

}  // namespace isthmus::pipelines
