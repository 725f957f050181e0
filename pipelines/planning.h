// Before the graph runs: what each file holds, one voxel for all scans, and where every product will lie.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_directory.h"
#include "pipelines/events.h"
#include "pipelines/scan_products.h"

namespace isthmus::pipelines {

/// A scan that cannot be worked on, and why.
struct FailedScan {
  int id = 0;
  Error error;
};

struct SurveyPlan {
  double voxel_m = 0;  ///< 0 when no scan could be planned
  bool automatic_voxel = false;
  std::vector<ScanPlan> scans;  ///< ascending ids
  std::vector<FailedScan> failed;
};

/// Reads digests and probes of all scans in parallel. An id is an index into `scans`. The voxel is the one from the
/// settings or follows from all scans together; it does not depend on their order. Scans that are empty or unreadable
/// are in `failed`.
SurveyPlan plan_survey(const std::vector<io::ListedScan>& scans, const Settings& settings, const store::Store& store,
                       const Events& events, const std::atomic<bool>& stop);

}  // namespace isthmus::pipelines
