#include "simulate/stations.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace isthmus::sim {
namespace {

constexpr double kClearance_m = 0.55;
constexpr double kGroundReach_m = 4.0;
constexpr double kGoldenAngle_rad = 2.39996322972865332;  // a sunflower spiral covers a disc evenly

}  // namespace

std::optional<double> height_above_ground_m(const RayScene& scene, const Vector3d& p, double reach_m) {
  const std::optional<Hit> ground = scene.trace(p, -Vector3d::UnitZ(), 0, reach_m);
  if (!ground || ground->normal.z() <= 0) return std::nullopt;
  return ground->range_m;
}

bool is_free(const RayScene& scene, const Vector3d& p, double clearance_m) {
  constexpr int kAzimuths = 24;
  constexpr double kFar_m = 500;
  for (const double below_m : {0.0, 0.4, 0.8, 1.2}) {
    for (int k = 0; k < kAzimuths; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / kAzimuths;
      const Vector3d direction(std::cos(azimuth), std::sin(azimuth), 0);
      const std::optional<Hit> hit = scene.trace(p - below_m * Vector3d::UnitZ(), direction, 0, kFar_m);
      if (!hit) continue;
      const bool from_inside = hit->normal.dot(direction) > 0 && !is_sheet(hit->material);
      if (hit->range_m < clearance_m || from_inside) return false;
    }
  }
  const std::optional<Hit> above = scene.trace(p, Vector3d::UnitZ(), 0, kFar_m);
  return !above || is_sheet(above->material) || above->normal.z() < 0;
}

Result<std::vector<Vector3d>> settle_stations(const RayScene& scene, const std::vector<Vector3d>& wishes) {
  constexpr int kTries = 400;
  constexpr double kStep_m = 0.12;
  std::vector<Vector3d> places;
  for (const Vector3d& wish : wishes) {
    const std::size_t before = places.size();
    for (int k = 0; k < kTries && places.size() == before; ++k) {
      const double radius = kStep_m * std::sqrt(k), angle = kGoldenAngle_rad * k;
      Vector3d p = wish + Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0);
      const std::optional<double> height = height_above_ground_m(scene, p, kGroundReach_m);
      if (height && is_free(scene, p, kClearance_m)) places.push_back(p);
    }
    if (places.size() == before) {
      return fail(fmt::format("no free place within {:.1f} m of ({:.2f}, {:.2f}, {:.2f}) for station {}",
                              kStep_m * std::sqrt(kTries), wish.x(), wish.y(), wish.z(), before),
                  "simulate", "another seed or spacing");
    }
  }
  return places;
}

}  // namespace isthmus::sim
