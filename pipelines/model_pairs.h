// Quick looks at many pairs: glances before any is registered (pairwise/screen_pair.h), checks of solved poses
// (pairwise/check_pose.h). Block by block, so that few scans are in memory and each is loaded few times.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pairwise/check_pose.h"
#include "pipelines/events.h"
#include "pipelines/scan_products.h"
#include "pipelines/share.h"
#include "survey/candidates.h"

namespace isthmus::pipelines {

struct ModelSources {
  const std::map<int, const ScanPlan*>& plans;  ///< by id
  const store::Store& store;
  std::function<Result<ScanProduct>(int id)> load;
  /// Every process needs all answers: each begins at a place of its own and takes what others stored meanwhile.
  Share share = {};
};

/// The pairs (source, target) that a glance can judge, in the given order; each glance is kept in the store. Pairs
/// whose products cannot be had, and all that is left when `stop` is set, are missing from the answer.
std::vector<ScreenedPair> screen_pairs(std::span<const std::pair<int, int>> pairs, const ModelSources& sources,
                                       const Events& events, const std::atomic<bool>& stop);

/// A pair and where it would stand.
struct PosedPair {
  int source = 0;
  int target = 0;
  Transform target_from_source = Transform::Identity();  ///< between local frames
};

/// A check for each pair, kept in the store; absent as above.
std::vector<std::optional<PoseCheck>> check_poses(std::span<const PosedPair> pairs, const ModelSources& sources,
                                                  const Events& events, const std::atomic<bool>& stop);

/// The likeness of the ground plans of all pairs, kept in the store as one product: a survey with one scan more
/// compares all anew. What is left when `stop` is set is 0, and then nothing is kept.
std::vector<float> compare_plans(std::span<const std::pair<int, int>> pairs,
                                 const std::function<float(std::size_t)>& compare, const ModelSources& sources,
                                 const Events& events, const std::atomic<bool>& stop);

}  // namespace isthmus::pipelines
