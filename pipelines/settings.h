// All settings of a run: every stage's options, and where each value came from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/option.h"
#include "features/describe.h"
#include "pairwise/register_pair.h"
#include "regions/divide.h"
#include "scan/sampling.h"
#include "survey/candidates.h"
#include "survey/pose_graph.h"

namespace isthmus::pipelines {

/// How a run is carried out; nothing here changes a result.
struct RunOptions {
  std::optional<int> threads;
  std::optional<double> memory_gb;
  std::string store;
};
const config::OptionTable<RunOptions>& run_options_table();

struct Settings {
  SamplingOptions sampling;
  FeatureOptions features;
  RegionOptions regions;
  PairOptions pair;
  CandidateOptions candidates;
  SolveOptions solve;
  RunOptions run;
  config::Origins origins;

  /// Views of the options above, in the order of the walk of a scan; valid as long as these settings stay where they
  /// are.
  std::vector<config::Stage> stages();
  /// The settings that name a file or folder: relative to a job's file when they stand in one. Valid as stages() is.
  std::vector<std::string*> paths() { return {&sampling.stations, &candidates.positions, &run.store}; }
};

/// Digests of the settings that decide each stage's result.
struct SettingsDigests {
  std::string sampling, features, regions, pair;
};
SettingsDigests digests_of(Settings settings);

/// Number of threads and bytes in flight that `run` asks for, automatic values filled in from the machine.
int threads_of(const RunOptions& run);
std::size_t memory_bytes_of(const RunOptions& run);

/// Settings from a file, or from a built-in profile if no such file exists and the text is a profile's name.
Result<void> apply_config(Settings& settings, const std::string& file_or_profile);
/// Each "stage.key=value".
Result<void> apply_assignments(Settings& settings, const std::vector<std::string>& assignments);

/// Names of the built-in profiles (configs/*.yaml but default.yaml), sorted.
std::vector<std::string> profile_names();

}  // namespace isthmus::pipelines
