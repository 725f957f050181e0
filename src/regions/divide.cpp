#include "regions/divide.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/point_grid.h"

namespace isthmus {

const config::OptionTable<RegionOptions>& region_options_table() {
  static const config::OptionTable<RegionOptions> table{
      "regions",
      "Division of a scan's keypoints into feature regions.",
      {
          {"division", &RegionOptions::division, "", 0, 0, {"clusters"},
           "How keypoints are divided: clusters = compact clusters of similar size.", "docs/stages/regions.md"},
          {"keypoints_per_region", &RegionOptions::keypoints_per_region, "", 5, 10000, {},
           "Keypoints that a region should hold. Smaller regions find smaller overlaps and cost more votes.",
           "docs/stages/regions.md"},
      }};
  return table;
}

namespace {

struct Clusters {
  std::vector<Eigen::Vector3f> centres;
  std::vector<std::uint32_t> assignment;
};

// Farthest-point seeds (deterministic, spread over the scan), then Lloyd's iterations.
Clusters compact_clusters(std::span<const Eigen::Vector3f> points, std::size_t k) {
  constexpr int kLloydSteps = 6;
  Clusters out;
  std::vector<float> sq_distance(points.size(), std::numeric_limits<float>::infinity());
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < k; ++c) {
    out.centres.push_back(points[next]);
    for (std::size_t i = 0; i < points.size(); ++i)
      sq_distance[i] = std::min(sq_distance[i], (points[i] - points[next]).squaredNorm());
    next = static_cast<std::uint32_t>(std::max_element(sq_distance.begin(), sq_distance.end()) - sq_distance.begin());
  }
  out.assignment.assign(points.size(), 0);
  for (int step = 0; step < kLloydSteps; ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      float best = std::numeric_limits<float>::infinity();
      for (std::uint32_t c = 0; c < out.centres.size(); ++c) {
        const float sq = (points[i] - out.centres[c]).squaredNorm();
        if (sq < best) best = sq, out.assignment[i] = c;
      }
    }
    std::vector<Eigen::Vector3d> sums(out.centres.size(), Eigen::Vector3d::Zero());
    std::vector<std::size_t> counts(out.centres.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i)
      sums[out.assignment[i]] += points[i].cast<double>(), ++counts[out.assignment[i]];
    for (std::size_t c = 0; c < out.centres.size(); ++c)
      if (counts[c]) out.centres[c] = (sums[c] / static_cast<double>(counts[c])).cast<float>();
  }
  return out;
}

void link_neighbours(RegionMap& map, std::span<const Eigen::Vector3f> points) {
  // Two regions touch when a keypoint of one lies within the typical distance between keypoints of the other.
  const std::size_t n = map.regions.size();
  float spacing = 0;
  for (const Region& r : map.regions)
    spacing = std::max(spacing, r.radius_m / std::sqrt(static_cast<float>(std::max<std::size_t>(r.keypoints.size(), 1))));
  if (!(spacing > 0)) return;
  const PointGrid grid(points, 2 * spacing);
  std::vector<std::vector<char>> touches(n, std::vector<char>(n, 0));
  for (std::size_t i = 0; i < points.size(); ++i)
    grid.for_each_within(points[i], 2 * spacing, [&](std::uint32_t j, float) {
      touches[map.region_of_keypoint[i]][map.region_of_keypoint[j]] = 1;
    });
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = 0; b < n; ++b)
      if (a != b && (touches[a][b] || touches[b][a])) map.regions[a].neighbours.push_back(b);
}

}  // namespace

RegionMap divide(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  RegionMap map;
  if (features.keypoints.empty()) return map;
  std::vector<Eigen::Vector3f> points;
  for (const std::uint32_t i : features.keypoints) points.push_back(scan.points[i]);
  const std::size_t wanted = std::max<std::size_t>(1, points.size() / static_cast<std::size_t>(options.keypoints_per_region));
  Clusters clusters = compact_clusters(points, wanted);
  std::vector<std::int64_t> renamed(clusters.centres.size(), -1);  // empty clusters vanish
  map.region_of_keypoint.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::int64_t& name = renamed[clusters.assignment[i]];
    if (name < 0) {
      name = static_cast<std::int64_t>(map.regions.size());
      map.regions.emplace_back();
    }
    map.region_of_keypoint[i] = static_cast<std::uint32_t>(name);
    map.regions[static_cast<std::size_t>(name)].keypoints.push_back(i);
  }
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
