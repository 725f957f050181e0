// Before the graph runs: what each file holds, one voxel for all scans, and where every product will lie.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_directory.h"
#include "pipelines/events.h"
#include "pipelines/scan_products.h"
#include "pipelines/share.h"

namespace isthmus::pipelines {

/// A scan that is not worked on, and why.
struct FailedScan {
  int id = 0;
  Error error;
  bool other_unit = false;  ///< it can be read, but seems to be in another unit than the others
};

struct SurveyPlan {
  double voxel_m = 0;  ///< 0 when no scan could be planned
  bool automatic_voxel = false;
  std::vector<ScanPlan> scans;  ///< ascending ids
  std::vector<FailedScan> failed;
  std::vector<int> unseen;  ///< new or changed, and not this process's to look at
  std::vector<std::string> warnings;
};

/// Reads digests and probes of all scans in parallel. An id is an index into `scans`. The voxel is the one from the
/// settings or follows from all scans together; it does not depend on their order. Scans that are empty, unreadable or
/// in another unit than the others are in `failed`. Errors name scans, not paths. With a share that is not the whole,
/// scans of others whose content is not known are `unseen`, and there is no voxel before all are known; a share that
/// only looks probes them to say which voxel it will be.
SurveyPlan plan_survey(const std::vector<io::ListedScan>& scans, const Settings& settings, const store::Store& store,
                       const Events& events, const std::atomic<bool>& stop, const Share& share = {});

/// io::take_readable_twins(), each file being read to its end. Runs in an arena of its own; what could be read is
/// remembered in the store.
void take_readable_twins(io::ScanListing& listing, const Settings& settings, const store::Store& store,
                         const std::atomic<bool>& stop);

}  // namespace isthmus::pipelines
