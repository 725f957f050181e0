// What moves into a place for the time of one scan.
#pragma once

#include "base/rng.h"
#include "simulate/ray_scene.h"
#include "simulate/scene.h"

namespace isthmus::sim {

/// People around `station` wherever there is room and ground, and cars on the scene's lanes near it; world coordinates.
Mesh movers_around(const Vector3d& station, const Scene& scene, const RayScene& fixed, Rng& rng);

}  // namespace isthmus::sim
