#include "pipelines/survey_record.h"

#include <fmt/format.h>
#include <Eigen/Core>

#include "config/describe.h"
#include "io/format_table.h"
#include "isthmus_version.h"
#include "pipelines/code_versions.h"

namespace isthmus::pipelines {
namespace {

report::ScanRecord record_of_scan(const ScanOutcome& scan, double voxel_m) {
  report::ScanRecord record;
  record.id = scan.id;
  record.name = scan.ref.name;
  record.voxel_m = voxel_m;
  if (const Result<const io::Format*> format = io::format_of(scan.ref.path)) record.format = (*format)->name;
  for (const StageTime& time : scan.times) record.seconds.emplace_back(time.stage, time.seconds);
  if (scan.error) record.reason = scan.error->text();
  if (!scan.summary) return record;
  const ScanSummary& summary = *scan.summary;
  record.points = summary.num_points;
  record.num_read = summary.num_read;
  record.num_dropped = summary.num_dropped;
  record.spacing_m = summary.spacing_m;
  record.station_kind = summary.station_kind;
  record.station = summary.station.cast<double>();
  record.centre = summary.centre;
  record.radius_m = summary.radius_m;
  record.local_origin_in_scan = summary.local_origin_in_scan;
  record.notes = summary.notes;
  return record;
}

/// The settings that decide results: the section `run` is left out, it may differ where results may not.
std::string settings_text(Settings settings) {
  std::vector<config::Stage> stages = settings.stages();
  std::erase_if(stages, [](const config::Stage& stage) { return stage.name == run_options_table().stage; });
  return config::values_yaml(stages);
}

}  // namespace

MeasuredSurvey measured_of(const Job& job, const SurveyOutcome& outcome, const std::vector<std::string>& of_listing) {
  MeasuredSurvey measured;
  const std::filesystem::path first = std::filesystem::absolute(job.inputs.front()).lexically_normal();
  measured.title = (first.has_filename() ? first : first.parent_path()).filename().string();
  measured.graph = outcome.graph;
  for (const ScanOutcome& scan : outcome.scans) {
    measured.scans.push_back(record_of_scan(scan, outcome.voxel_m));
    if (scan.summary && !scan.error) measured.view_keys.push_back({scan.id, scan.sampled, scan.intensity});
  }
  measured.warnings = of_listing;
  measured.warnings.insert(measured.warnings.end(), outcome.warnings.begin(), outcome.warnings.end());
  return measured;
}

report::SurveyRecord record_of(const Job& job, const MeasuredSurvey& measured, Solution solution) {
  report::SurveyRecord record;
  record.title = measured.title;
  record.voxel_m = measured.graph.voxel_m;
  record.scans = measured.scans;
  record.solution = std::move(solution);
  record.settings_yaml = settings_text(job.settings);
  record.versions = {{"isthmus", kVersion},
                     {"code", kPairVersion},
                     {"compiler", fmt::format("gcc {}", __VERSION__)},
                     {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)}};
  record.warnings = measured.warnings;
  report::judge_scans(record);
  return record;
}

}  // namespace isthmus::pipelines
