// What divisions share: neighbouring keypoints, groups brought to similar size, groups made regions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "features/feature_cloud.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// The group of each keypoint. Any numbers will do.
using Groups = std::vector<std::uint32_t>;
inline constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

std::vector<Eigen::Vector3f> keypoint_positions(const SampledScan& scan, const FeatureCloud& features);

/// For each point its nearest others, nearest first, ties to the smaller index.
struct NearestPoints {
  std::size_t count = 0;             ///< the same for all points: fewer than wanted when there are not as many
  std::vector<std::uint32_t> index;  ///< points x count
  std::vector<float> sq_distance;    ///< the same shape, m2
};
/// first_reach_m: about as far as the neighbours usually lie; it decides the time, not the answer.
NearestPoints nearest_points(std::span<const Eigen::Vector3f> points, std::size_t count, float first_reach_m);
inline constexpr float kKeypointReachVoxels =
    4;  ///< holds the nearest keypoints of a surface at their usual spacing of 2

inline constexpr double kLargestRegion = 1.5;  ///< of the wanted size: from here on two halves are nearer to it

/// Makes groups of about `wanted` points out of any: small ones join the group (or the rest, kNoGroup) that most of
/// their near neighbours belong to; what then remains small or has no group falls to compact clusters; large ones are
/// split into compact clusters.
Groups of_similar_size(std::span<const Eigen::Vector3f> points, const NearestPoints& nearest, Groups groups,
                       std::size_t wanted);

/// One region for each group, numbered by their first keypoints, with centre, normal, radius and neighbours. Two
/// regions touch when a keypoint of one lies within twice the typical distance of keypoints of the other.
/// Precondition: no keypoint is in kNoGroup.
RegionMap region_map_of(const SampledScan& scan, const FeatureCloud& features, const Groups& groups);

}  // namespace isthmus
