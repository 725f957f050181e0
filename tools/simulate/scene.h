// A made-up place: solids, where the scanner stands, and where things may move. Metres, z up, common frame.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

/// A stretch of road on which cars drive, both ways.
struct Lane {
  Vector3d from, to;
};

struct Scene {
  Mesh mesh;
  std::vector<Vector3d>
      stations;                ///< wished-for scanner centres, in the order of the walk; settle_stations() moves them
  std::vector<Lane> lanes;     ///< where moving cars may be; their height comes from the ground below
  double people_per_scan = 0;  ///< mean number of moving people around a station
};

struct SceneRequest {
  int num_stations = 1;
  double spacing_m = 0;  ///< distance between neighbouring stations of the walk; > 0
  std::uint64_t seed = 0;
};

/// The names that build_scene() knows.
const std::vector<std::string>& scene_names();
/// The spacing at which neighbours overlap little but the survey stays connected (docs/simulate.md has the table).
double default_spacing_m(std::string_view scene);
/// Precondition: `scene` is one of scene_names().
Scene build_scene(std::string_view scene, const SceneRequest& request);

Scene build_office(const SceneRequest& request);
Scene build_street(const SceneRequest& request);
Scene build_campus(const SceneRequest& request);
Scene build_forest(const SceneRequest& request);
Scene build_tunnel(const SceneRequest& request);
Scene build_hall(const SceneRequest& request);

/// True with probability p.
inline bool chance(Rng& rng, double p) { return rng.uniform() < p; }
/// A scanner on its tripod, above the ground.
inline double tripod_height_m(Rng& rng) { return rng.uniform(1.55, 1.85); }

}  // namespace isthmus::sim
