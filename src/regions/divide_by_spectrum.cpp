#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "regions/divisions.h"
#include "regions/fiedler.h"
#include "regions/region_parts.h"

namespace isthmus {
namespace {

constexpr double kSmallerPart = 0.25;  // a cut leaves at least this share on either side
constexpr float kNormalScale = 0.5f;   // of 1 - cosine: a right angle between normals weakens a tie to e^-2

// Keypoints that are near each other and face alike hang together: ties weigh exp(-d^2 / (s_i s_j)), each keypoint with
// its own scale s, the distance to the last of its neighbours (Zelnik-Manor, Perona 2004), less for turned normals.
WeightedGraph ties_between_keypoints(const SampledScan& scan, const FeatureCloud& features,
                                     const NearestPoints& nearest) {
  const std::size_t n = features.keypoints.size(), k = nearest.count;
  const auto scale = [&](std::size_t i) { return std::sqrt(nearest.sq_distance[i * k + k - 1]); };
  std::vector<WeightedGraph::Tie> ties;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::size_t rank = 0; rank < k; ++rank) {
      const std::uint32_t j = nearest.index[i * k + rank];
      const float scales = std::max(scale(i) * scale(j), std::numeric_limits<float>::min());
      const float turn = 1 - scan.normals[features.keypoints[i]].dot(scan.normals[features.keypoints[j]]);
      ties.push_back(
          {i, j, static_cast<double>(std::exp(-nearest.sq_distance[i * k + rank] / scales - turn / kNormalScale))});
    }
  return WeightedGraph(n, ties);
}

// Members in the order of the cut vector, and the number of them on its first side: where the normalised cut (Shi,
// Malik 2000, section 2) is least among those that leave enough on either side.
std::pair<std::vector<std::uint32_t>, std::size_t> least_cut(const WeightedGraph& graph,
                                                             const std::vector<double>& position) {
  const std::size_t n = graph.size();
  std::vector<std::uint32_t> order(n);
  for (std::uint32_t i = 0; i < n; ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return position[i]; });
  double total = 0, first = 0, cut = 0, least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < n; ++i) total += graph.degree(i);
  std::vector<char> moved(n, 0);
  const auto fewest = std::max<std::size_t>(1, static_cast<std::size_t>(kSmallerPart * static_cast<double>(n)));
  std::size_t best = n / 2;
  for (std::size_t k = 0; k + fewest < n; ++k) {
    const std::uint32_t i = order[k];
    for (const auto& [j, weight] : graph.around(i)) cut += moved[j] ? -weight : weight;
    moved[i] = 1;
    first += graph.degree(i);
    const double ncut = cut / first + cut / (total - first);
    if (k + 1 >= fewest && ncut < least) least = ncut, best = k + 1;
  }
  return {order, best};
}

}  // namespace

RegionMap divide_by_spectrum(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  const auto wanted = static_cast<std::size_t>(options.keypoints_per_region);
  const auto points = keypoint_positions(scan, features);
  const NearestPoints nearest = nearest_points(points, static_cast<std::size_t>(options.spectral_neighbours),
                                               kKeypointReachVoxels * static_cast<float>(scan.voxel_m));
  const WeightedGraph whole = ties_between_keypoints(scan, features, nearest);
  Groups groups(points.size(), 0);
  std::uint32_t num_groups = 0;
  std::vector<std::vector<std::uint32_t>> waiting = whole.components();
  while (!waiting.empty()) {
    const std::vector<std::uint32_t> members = std::move(waiting.back());
    waiting.pop_back();
    if (members.size() < 2 || static_cast<double>(members.size()) <= kLargestRegion * static_cast<double>(wanted)) {
      for (const std::uint32_t i : members) groups[i] = num_groups;
      ++num_groups;
      continue;
    }
    const WeightedGraph part = whole.part(members);
    const auto [order, size] = least_cut(part, fiedler_positions(part));
    std::vector<std::vector<std::uint32_t>> sides(2);
    for (std::size_t k = 0; k < order.size(); ++k) sides[k < size ? 0 : 1].push_back(members[order[k]]);
    for (auto& side : sides) {
      std::ranges::sort(side);
      // A side of a cut may fall apart.
      for (const auto& component : whole.part(side).components()) {
        waiting.emplace_back();
        for (const std::uint32_t i : component) waiting.back().push_back(side[i]);
      }
    }
  }
  return region_map_of(scan, features, of_similar_size(points, nearest, std::move(groups), wanted));
}

}  // namespace isthmus
