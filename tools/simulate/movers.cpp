#include "simulate/movers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/objects.h"
#include "simulate/stations.h"

namespace isthmus::sim {
namespace {

constexpr double kNearest_m = 1.2;  // nobody stands in the tripod
constexpr double kFarthest_m = 15;

/// A count with the given mean: as many successes as fit (geometric, so that empty scans and crowds both occur).
int random_count(double mean, Rng& rng) {
  int count = 0;
  const double again = mean / (1 + mean);
  while (count < 40 && chance(rng, again)) ++count;
  return count;
}

void add_people(Mesh& mesh, const Vector3d& station, double mean, const RayScene& fixed, Rng& rng) {
  constexpr double kBody_m = 0.5;
  const int count = random_count(mean, rng);
  for (int k = 0; k < count; ++k) {
    const double azimuth = rng.uniform(0, 2 * std::numbers::pi), share = rng.uniform(),
                 yaw = rng.uniform(0, 2 * std::numbers::pi);
    const Vector3d direction(std::cos(azimuth), std::sin(azimuth), 0);
    const std::optional<Hit> wall = fixed.trace(station - 0.6 * Vector3d::UnitZ(), direction, 0, kFarthest_m);
    const double room_m = (wall ? wall->range_m : kFarthest_m) - kBody_m;
    if (room_m < kNearest_m) continue;
    const Vector3d above = station + (kNearest_m + share * (room_m - kNearest_m)) * direction;
    const std::optional<double> height = height_above_ground_m(fixed, above, 5.0);
    if (height && *height > 1.0) add_person(mesh, upright(above - *height * Vector3d::UnitZ(), yaw), rng);
  }
}

void add_cars(Mesh& mesh, const Vector3d& station, const std::vector<Lane>& lanes, const RayScene& fixed, Rng& rng) {
  constexpr double kReach_m = 60, kCarsPerLane = 0.35, kApart_m = 4.0, kDrop_m = 30;
  for (const Lane& lane : lanes) {
    const Vector3d along = lane.to - lane.from;
    const double share = rng.uniform();
    const bool is_taken = chance(rng, kCarsPerLane);
    const Vector3d p = lane.from + share * along;
    const double distance = (p - station).head<2>().norm();
    if (!is_taken || distance > kReach_m || distance < kApart_m) continue;
    const Vector3d above(p.x(), p.y(), p.z() + 1.2);
    const std::optional<double> height = height_above_ground_m(fixed, above, kDrop_m);
    if (!height || *height < 0.6) continue;
    add_car(mesh, upright(above - *height * Vector3d::UnitZ(), std::atan2(along.y(), along.x())), rng);
  }
}

}  // namespace

Mesh movers_around(const Vector3d& station, const Scene& scene, const RayScene& fixed, Rng& rng) {
  Mesh mesh;
  if (scene.people_per_scan > 0) add_people(mesh, station, scene.people_per_scan, fixed, rng);
  add_cars(mesh, station, scene.lanes, fixed, rng);
  return mesh;
}

}  // namespace isthmus::sim
