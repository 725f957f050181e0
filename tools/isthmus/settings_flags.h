// The flags that several commands share: configuration, settings, threads, memory, store.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "pipelines/job.h"

namespace isthmus::cli {

struct SettingsFlags {
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  std::string threads;
  std::string memory_gb;
  std::string store;
  std::string shard;
  double wait_s = pipelines::Job().wait_s;

  void add_config(CLI::App& command);     ///< -c
  void add_overrides(CLI::App& command);  ///< --set, --threads, --memory
  void add_store(CLI::App& command);      ///< --store
  void add_shard(CLI::App& command);      ///< --shard, --wait

  /// Files and profiles first, then --set, then the flags; on top of what `settings` holds.
  [[nodiscard]] Result<void> apply(pipelines::Settings& settings) const;
  /// apply() on the job's settings, and the shard.
  [[nodiscard]] Result<void> apply(pipelines::Job& job) const;
  /// The job of a command that names scans and an output, with all of the above.
  [[nodiscard]] Result<pipelines::Job> job(const std::vector<std::string>& inputs, const std::string& output) const;
};

}  // namespace isthmus::cli
