// Descriptor matches between two scans.
#pragma once

#include <cstdint>
#include <vector>

#include "features/feature_cloud.h"

namespace isthmus {

/// For every source keypoint its `count` most similar target keypoints, most similar first.
struct MatchTable {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> target;  ///< source keypoints x count, indices into the target's keypoints
  std::vector<float> similarity;      ///< the same shape: scalar product of the descriptors
};

/// Exhaustive search by matrix products; deterministic, ties go to the smaller index. `count` is lowered to the number
/// of target keypoints. Both clouds must have the same descriptor dimension.
MatchTable match_descriptors(const FeatureCloud& source, const FeatureCloud& target, std::uint32_t count);

}  // namespace isthmus
