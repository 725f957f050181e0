// One pair from features to verdict.
#pragma once

#include <span>

#include "config/option_table.h"
#include "features/feature_cloud.h"
#include "pairwise/pair_result.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Everything the pair stage needs of one scan: what the store keeps.
struct ScanProduct {
  SampledScan sampled;
  FeatureCloud features;
  RegionMap regions;
  template <class F>
  void fields(F&& f) { f(sampled), f(features), f(regions); }
};

struct PairOptions {
  int nearest_descriptors = 10;
};
const config::OptionTable<PairOptions>& pair_options_table();

/// Registers source to target. `priors` are extra hypotheses (target_from_source between local frames) judged like the
/// others. Deterministic for any thread count; uses TBB loops inside. Never throws for data reasons: a useless input gives
/// Verdict::failed or rejected with a reason. Both scans must have the same voxel_m.
PairResult register_pair(const ScanProduct& source, const ScanProduct& target, const PairOptions& options,
                         std::span<const Transform> priors = {});

}  // namespace isthmus
