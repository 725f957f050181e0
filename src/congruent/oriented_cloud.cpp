#include "congruent/oriented_cloud.h"

#include <algorithm>
#include <set>
#include <utility>

#include "congruent/cell_table.h"

namespace isthmus::congruent {
namespace {

constexpr double kDiameterQuantile = 0.9;
constexpr float kShortestNormal = 1e-3F;  // a mean of opposite normals, not a direction

double robust_diameter(const std::vector<Eigen::Vector3f>& points) {
  if (points.empty()) return 0;
  std::vector<float> distances(points.size());
  std::transform(points.begin(), points.end(), distances.begin(), [](const auto& p) { return p.norm(); });
  const auto nth =
      distances.begin() + static_cast<std::ptrdiff_t>(kDiameterQuantile * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), nth, distances.end());
  return 2.0 * static_cast<double>(*nth);
}

// Which face of a cube a direction leaves through.
int facing_side(const Eigen::Vector3f& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (normal[axis] > 0 ? 1 : 0);
}

LocalCloud without_points(const LocalCloud& cloud) {
  LocalCloud empty;
  empty.centre = cloud.centre;
  empty.diameter_m = cloud.diameter_m;
  return empty;
}

void copy_point(const LocalCloud& from, std::size_t i, LocalCloud& to) {
  to.points.push_back(from.points[i]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[i]);
}

}  // namespace

LocalCloud recentred(const OrientedCloud& cloud, bool use_normals) {
  LocalCloud local;
  std::vector<std::size_t> kept;
  kept.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const bool usable = cloud.points[i].allFinite() &&
                        (!use_normals || (cloud.normals[i].allFinite() && cloud.normals[i].norm() > kShortestNormal));
    if (!usable) continue;
    kept.push_back(i);
    local.centre += cloud.points[i].cast<double>();
  }
  local.num_dropped = cloud.points.size() - kept.size();
  if (kept.empty()) return local;
  local.centre /= static_cast<double>(kept.size());
  for (const std::size_t i : kept) {
    if (!cloud.at_boundary.empty() && cloud.at_boundary[i] != 0)
      local.boundary.push_back(static_cast<std::uint32_t>(local.points.size()));
    local.points.push_back((cloud.points[i].cast<double>() - local.centre).cast<float>());
    if (use_normals) local.normals.push_back(cloud.normals[i].normalized());
  }
  local.diameter_m = robust_diameter(local.points);
  return local;
}

LocalCloud thinned_by_cells(const LocalCloud& cloud, double edge_m) {
  if (!(edge_m > 0)) return cloud;
  std::set<std::pair<CellKey, int>> taken;
  LocalCloud thin = without_points(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const CellKey cell = cell_key(cell_of(cloud.points[i], 1 / static_cast<float>(edge_m)));
    const int side = cloud.normals.empty() ? 0 : facing_side(cloud.normals[i]);
    if (taken.emplace(cell, side).second) copy_point(cloud, i, thin);
  }
  return thin;
}

LocalCloud thinned_by_lot(const LocalCloud& cloud, std::size_t max_points, Rng rng) {
  if (cloud.points.size() <= max_points) return cloud;
  LocalCloud thin = without_points(cloud);
  std::size_t wanted = max_points;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {  // selection sampling (Knuth, volume 2, algorithm S)
    if (rng.below(cloud.points.size() - i) >= wanted) continue;
    --wanted;
    copy_point(cloud, i, thin);
  }
  return thin;
}

}  // namespace isthmus::congruent
