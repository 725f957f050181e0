// One pair of files, from paths to a verdict.
#pragma once

#include "pipelines/events.h"
#include "pipelines/scan_products.h"
#include "pipelines/settings.h"

namespace isthmus::pipelines {

struct PairAnswer {
  PairResult result;  ///< between local frames
  bool from_store = false;
  double voxel_m = 0;
  std::optional<Transform> target_from_source_in_scans;  ///< between the files' own coordinates
  Matrix6d information_in_scans = Matrix6d::Zero();      ///< for a right perturbation in the source's coordinates
  std::vector<StageTime> source_times;
  std::vector<StageTime> target_times;
};

/// Fails when one of the scans cannot be read or reduced; scans in different units are a failed pair. Runs in an arena
/// of its own.
Result<PairAnswer> run_pair(const io::ScanRef& source, const io::ScanRef& target, const Settings& settings,
                            const store::Store& store, const Events& events);

}  // namespace isthmus::pipelines
