#include "regions/compact_clusters.h"

#include <algorithm>
#include <limits>

namespace isthmus {
namespace {

std::vector<Eigen::Vector3f> farthest_points(std::span<const Eigen::Vector3f> points, std::size_t k) {
  std::vector<Eigen::Vector3f> centres;
  std::vector<float> sq_distance(points.size(), std::numeric_limits<float>::infinity());
  std::size_t next = 0;
  for (std::size_t c = 0; c < k; ++c) {
    centres.push_back(points[next]);
    for (std::size_t i = 0; i < points.size(); ++i)
      sq_distance[i] = std::min(sq_distance[i], (points[i] - points[next]).squaredNorm());
    next = static_cast<std::size_t>(std::ranges::max_element(sq_distance) - sq_distance.begin());
  }
  return centres;
}

}  // namespace

std::vector<std::uint32_t> compact_clusters(std::span<const Eigen::Vector3f> points, std::size_t k) {
  constexpr int kLloydSteps = 6;
  std::vector<std::uint32_t> cluster(points.size(), 0);
  if (points.empty()) return cluster;
  std::vector<Eigen::Vector3f> centres = farthest_points(points, k);
  for (int step = 0; step < kLloydSteps; ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      float best = std::numeric_limits<float>::infinity();
      for (std::uint32_t c = 0; c < centres.size(); ++c) {
        const float sq = (points[i] - centres[c]).squaredNorm();
        if (sq < best) best = sq, cluster[i] = c;
      }
    }
    std::vector<Eigen::Vector3d> sums(centres.size(), Eigen::Vector3d::Zero());
    std::vector<std::size_t> counts(centres.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) sums[cluster[i]] += points[i].cast<double>(), ++counts[cluster[i]];
    for (std::size_t c = 0; c < centres.size(); ++c)
      if (counts[c]) centres[c] = (sums[c] / static_cast<double>(counts[c])).cast<float>();
  }
  return cluster;
}

}  // namespace isthmus
