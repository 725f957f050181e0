// One pair from features to verdict.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/option_table.h"
#include "features/feature_cloud.h"
#include "pairwise/pair_result.h"
#include "regions/region_map.h"
#include "regions/upright_memo.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Everything the pair stage needs of one scan: what the store keeps.
struct ScanProduct {
  SampledScan sampled;
  FeatureCloud features;
  RegionMap regions;
  mutable UprightMemo uprights;  ///< for as long as the product is in memory
  template <class F>
  void fields(F&& f) {
    f(sampled), f(features), f(regions);
  }
};

struct PairOptions {
  std::vector<std::string> generators{"axis_votes", "column_votes", "pair_votes", "stem_votes"};
  int matches_per_keypoint = 15;
  double vote_window_voxels = 16;
  int max_seeds = 300;
  int max_ranked_seeds = 100;
  int max_hypotheses = 150;
  int congruent_hypotheses = 4;
  int fine_hypotheses = 40;
  int congruent_points = 600;
  std::string congruent_bases = "area";
  int score_points = 2000;
  double accept_probability = 0.97;
  double ambiguous_probability = 0.05;
  std::vector<std::string> without;

  [[nodiscard]] bool leaves_out(std::string_view part) const {
    return std::find(without.begin(), without.end(), part) != without.end();
  }
};
const config::OptionTable<PairOptions>& pair_options_table();

/// What each stage proposed, best first: for experiments, see tools/bench.
struct PairTrace {
  std::vector<Transform> seeds, grown, polished, congruent, fine;
};

/// Registers source to target. `priors` are extra hypotheses (target_from_source between local frames) judged like the
/// others. Deterministic for any thread count; uses TBB loops inside. Never throws for data reasons: a useless input
/// gives Verdict::failed or rejected with a reason. Both scans must have the same voxel_m.
PairResult register_pair(const ScanProduct& source, const ScanProduct& target, const PairOptions& options,
                         std::span<const Transform> priors = {}, PairTrace* trace = nullptr);

}  // namespace isthmus
