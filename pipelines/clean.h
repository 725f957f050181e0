// Collects from a store what none of the outputs that use it needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/collect.h"

namespace isthmus::pipelines {

struct Cleaning {
  std::filesystem::path store;
  std::vector<std::filesystem::path> outputs;  ///< whose needs were counted
  store::Collected collected;
};

/// Needed is what the journals of an output name since its last run that came to its end, that run included: what a
/// rerun would find, and what a killed or stopped one needs to go on. Journals before that run go. `store` is taken
/// from the output's last job if it is empty. Fails when a run works in the output or in the store.
Result<Cleaning> clean_output(const std::filesystem::path& output, const std::filesystem::path& store,
                              const store::CollectLimits& limits, bool dry_run);

}  // namespace isthmus::pipelines
