// The flags that several commands share: configuration, settings, threads, memory, store.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "pipelines/settings.h"

namespace isthmus::cli {

struct SettingsFlags {
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  std::string threads;
  std::string memory_gb;
  std::string store;

  void add_config(CLI::App& command);     ///< -c
  void add_overrides(CLI::App& command);  ///< --set, --threads, --memory
  void add_store(CLI::App& command);      ///< --store

  /// Files and profiles first, then --set, then the flags; on top of what `settings` holds.
  [[nodiscard]] Result<void> apply(pipelines::Settings& settings) const;
};

}  // namespace isthmus::cli
