// Jobs: what to register, where to, with which settings; from the command line or from a YAML file.
//
//   input: scans/            # a folder, or a list of files; paths are relative to this file
//   output: out/
//   profile: quick           # optional: a built-in profile or a configuration file; a list is applied in order
//   control: control.yaml    # optional: known points and poses, docs/stages/control.md
//   settings: {sampling: {voxel_m: 0.1}}
//
// A list of such jobs is a batch.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/settings.h"
#include "pipelines/share.h"

namespace isthmus::pipelines {

struct Job {
  std::string origin;                         ///< "command line", "batch.yaml:12"
  std::vector<std::filesystem::path> inputs;  ///< one folder, or files
  std::filesystem::path output;
  std::filesystem::path control;  ///< file of known points and poses; empty: none
  Settings settings;
  Share share;          ///< of the work; not part of the file
  double wait_s = 600;  ///< a shard waits for others as long as something new comes from them within this time
};

/// A word for what all shards of one plan have in common: inputs, output, settings but for `run`, number of shards.
std::string plan_word(const Job& job);

/// The job or jobs of a file, every one checked; wrong ones are errors with file, line and column.
Result<std::vector<Job>> read_jobs(const std::filesystem::path& file);

/// A job file that repeats the job: paths relative to `folder`, every setting with where it came from.
std::string resolved_job(const Job& job, const std::filesystem::path& folder);

/// The folder of a job's products: its setting run.store, else OUTPUT/store.
std::filesystem::path store_folder(const Job& job);

}  // namespace isthmus::pipelines
