// Where scanners can stand: wished-for places are moved until they are free.
#pragma once

#include <vector>

#include "base/error.h"
#include "simulate/ray_scene.h"

namespace isthmus::sim {

/// Metres above the ground below `p`, or nothing if there is no ground within `reach_m` or `p` is inside a solid.
std::optional<double> height_above_ground_m(const RayScene& scene, const Vector3d& p, double reach_m);

/// True when no surface is nearer than `clearance_m` around the tripod and the scanner is not inside a solid.
bool is_free(const RayScene& scene, const Vector3d& p, double clearance_m);

/// The wishes, each moved sideways as little as needed to be free, at its wished height above the ground found there.
/// Fails naming the first station that finds no place.
Result<std::vector<Vector3d>> settle_stations(const RayScene& scene, const std::vector<Vector3d>& wishes);

}  // namespace isthmus::sim
