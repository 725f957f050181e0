#include "regions/region_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "geometry/point_grid.h"
#include "regions/compact_clusters.h"

namespace isthmus {
namespace {

constexpr double kSmallestRegion = 0.5;  // of the wanted size: below, joined to another it comes nearer to it

// The distance that few neighbours lie beyond: longer ties lead to other things.
float near_limit_sq(const NearestPoints& nearest) {
  constexpr float kTypicalDistances = 2;
  if (nearest.count == 0) return 0;
  std::vector<float> farthest;
  for (std::size_t i = nearest.count - 1; i < nearest.sq_distance.size(); i += nearest.count)
    farthest.push_back(nearest.sq_distance[i]);
  const auto middle = farthest.begin() + static_cast<std::ptrdiff_t>(farthest.size() / 2);
  std::nth_element(farthest.begin(), middle, farthest.end());
  return kTypicalDistances * kTypicalDistances * *middle;
}

// Gives groups the numbers 0, 1, ... by their first members; returns how many there are.
std::uint32_t renumber(Groups& groups) {
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t& group : groups)
    if (group != kNoGroup) group = number.try_emplace(group, static_cast<std::uint32_t>(number.size())).first->second;
  return static_cast<std::uint32_t>(number.size());
}

std::vector<std::size_t> sizes_of(const Groups& groups, std::uint32_t num_groups) {
  std::vector<std::size_t> sizes(num_groups, 0);
  for (const std::uint32_t group : groups)
    if (group != kNoGroup) ++sizes[group];
  return sizes;
}

// For each group, how many near ties it has to every other and to the rest.
using Ties = std::vector<std::map<std::uint32_t, std::size_t>>;
Ties ties_of(const NearestPoints& nearest, const Groups& groups, std::uint32_t num_groups) {
  const float limit_sq = near_limit_sq(nearest);
  Ties ties(num_groups);
  for (std::size_t k = 0; k < nearest.index.size(); ++k) {
    const std::uint32_t a = groups[k / nearest.count], b = groups[nearest.index[k]];
    if (a == b || nearest.sq_distance[k] > limit_sq) continue;
    if (a != kNoGroup) ++ties[a][b];
    if (b != kNoGroup) ++ties[b][a];
  }
  return ties;
}

// One round of joining; false when no small group has anyone to join.
bool join_small(const NearestPoints& nearest, Groups& groups, std::size_t smallest) {
  const std::uint32_t num_groups = renumber(groups);
  std::vector<std::size_t> sizes = sizes_of(groups, num_groups);
  const Ties ties = ties_of(nearest, groups, num_groups);
  std::vector<std::uint32_t> order(num_groups), now(num_groups);
  std::iota(order.begin(), order.end(), 0U);
  std::iota(now.begin(), now.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t g) { return sizes[g]; });
  const auto now_in = [&](std::uint32_t g) {
    while (g != kNoGroup && now[g] != g) g = now[g];
    return g;
  };
  bool joined = false;
  for (const std::uint32_t g : order) {
    if (now[g] != g || sizes[g] >= smallest) continue;
    std::map<std::uint32_t, std::size_t> strength;
    for (const auto& [other, count] : ties[g])
      if (const std::uint32_t o = now_in(other); o != g) strength[o] += count;
    if (strength.empty()) continue;
    const auto best = std::ranges::max_element(strength, {}, [](const auto& s) { return s.second; })->first;
    now[g] = best;
    if (best != kNoGroup) sizes[best] += sizes[g];
    joined = true;
  }
  for (std::uint32_t& group : groups) group = now_in(group);
  return joined;
}

// Replaces the group of `members` by compact clusters of about `wanted` points, numbered from `first_free`.
void cluster(std::span<const Eigen::Vector3f> points, const std::vector<std::uint32_t>& members, std::size_t wanted,
             Groups& groups, std::uint32_t& first_free) {
  std::vector<Eigen::Vector3f> part;
  for (const std::uint32_t i : members) part.push_back(points[i]);
  const std::size_t k = std::max<std::size_t>(1, (members.size() + wanted / 2) / wanted);
  const auto clusters = compact_clusters(part, k);
  for (std::size_t i = 0; i < members.size(); ++i) groups[members[i]] = first_free + clusters[i];
  first_free += static_cast<std::uint32_t>(k);
}

void link_neighbours(RegionMap& map, std::span<const Eigen::Vector3f> points) {
  std::vector<float> reach_m;
  for (const Region& r : map.regions)
    reach_m.push_back(2 * r.radius_m / std::sqrt(static_cast<float>(r.keypoints.size())));
  const float longest = std::ranges::max(reach_m);
  if (!(longest > 0)) return;
  const PointGrid grid(points, longest);
  std::vector<std::vector<char>> touches(map.regions.size(), std::vector<char>(map.regions.size(), 0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t own = map.region_of_keypoint[i];
    grid.for_each_within(points[i], reach_m[own], [&](std::uint32_t j, float) {
      touches[own][map.region_of_keypoint[j]] = touches[map.region_of_keypoint[j]][own] = 1;
    });
  }
  for (std::uint32_t a = 0; a < map.regions.size(); ++a)
    for (std::uint32_t b = 0; b < map.regions.size(); ++b)
      if (a != b && touches[a][b]) map.regions[a].neighbours.push_back(b);
}

}  // namespace

std::vector<Eigen::Vector3f> keypoint_positions(const SampledScan& scan, const FeatureCloud& features) {
  std::vector<Eigen::Vector3f> points;
  for (const std::uint32_t i : features.keypoints) points.push_back(scan.points[i]);
  return points;
}

NearestPoints nearest_points(std::span<const Eigen::Vector3f> points, std::size_t count, float first_reach_m) {
  constexpr int kDoublings = 3;  // beyond, a look at all points is cheaper than at all cells in between
  NearestPoints nearest;
  nearest.count = points.empty() ? 0 : std::min(count, points.size() - 1);
  nearest.index.resize(points.size() * nearest.count);
  nearest.sq_distance.resize(points.size() * nearest.count);
  if (nearest.count == 0) return nearest;
  const PointGrid grid(points, first_reach_m);
  parallel_for_index(points.size(), 64, [&](std::size_t i) {
    std::vector<std::pair<float, std::uint32_t>> found;
    float reach_m = first_reach_m;
    for (int k = 0; k <= kDoublings && found.size() < nearest.count; ++k, reach_m *= 2) {
      found.clear();
      grid.for_each_within(points[i], reach_m, [&](std::uint32_t j, float sq) {
        if (j != i) found.emplace_back(sq, j);
      });
    }
    if (found.size() < nearest.count) {
      found.clear();
      for (std::uint32_t j = 0; j < points.size(); ++j)
        if (j != i) found.emplace_back((points[j] - points[i]).squaredNorm(), j);
    }
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(nearest.count), found.end());
    for (std::size_t k = 0; k < nearest.count; ++k) {
      nearest.sq_distance[i * nearest.count + k] = found[k].first;
      nearest.index[i * nearest.count + k] = found[k].second;
    }
  });
  return nearest;
}

Groups of_similar_size(std::span<const Eigen::Vector3f> points, const NearestPoints& nearest, Groups groups,
                       std::size_t wanted) {
  const auto smallest = static_cast<std::size_t>(std::ceil(kSmallestRegion * static_cast<double>(wanted)));
  const auto largest = static_cast<std::size_t>(kLargestRegion * static_cast<double>(wanted));
  while (join_small(nearest, groups, smallest)) {
  }
  std::uint32_t first_free = renumber(groups);
  std::vector<std::vector<std::uint32_t>> members(first_free);
  std::vector<std::uint32_t> rest;
  const std::vector<std::size_t> sizes = sizes_of(groups, first_free);
  for (std::uint32_t i = 0; i < groups.size(); ++i)
    (groups[i] == kNoGroup || sizes[groups[i]] < smallest ? rest : members[groups[i]]).push_back(i);
  for (const auto& group : members)
    if (group.size() > largest) cluster(points, group, wanted, groups, first_free);
  if (!rest.empty()) cluster(points, rest, wanted, groups, first_free);
  return groups;
}

RegionMap region_map_of(const SampledScan& scan, const FeatureCloud& features, const Groups& groups) {
  RegionMap map;
  if (groups.empty()) return map;
  map.region_of_keypoint = groups;
  map.regions.resize(renumber(map.region_of_keypoint));
  for (std::uint32_t k = 0; k < groups.size(); ++k) map.regions[map.region_of_keypoint[k]].keypoints.push_back(k);
  const auto points = keypoint_positions(scan, features);
  for (Region& region : map.regions) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    for (const std::uint32_t k : region.keypoints)
      centre += points[k].cast<double>(), normal += scan.normals[features.keypoints[k]].cast<double>();
    region.centre = (centre / static_cast<double>(region.keypoints.size())).cast<float>();
    region.normal = (normal / static_cast<double>(region.keypoints.size())).cast<float>();
    for (const std::uint32_t k : region.keypoints)
      region.radius_m = std::max(region.radius_m, (points[k] - region.centre).norm());
  }
  link_neighbours(map, points);
  return map;
}

}  // namespace isthmus
