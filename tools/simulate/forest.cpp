// A forest on uneven ground: leaning trunks, dead twigs, bushes, stumps, logs, rocks; a walk back and forth between
// them.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "simulate/plants.h"
#include "simulate/scene.h"
#include "simulate/terrain.h"

namespace isthmus::sim {
namespace {

constexpr double kMargin_m = 28;  ///< forest beyond the outermost stations

/// Random places at least `apart_m` from each other, found by dart throwing over a grid of cells (Bridson 2007 has the
/// idea).
std::vector<Vector2d> scattered(const Vector2d& low, const Vector2d& high, double apart_m, double darts_per_m2,
                                Rng& rng) {
  std::unordered_map<std::int64_t, std::vector<Vector2d>> cells;
  const auto cell_of = [&](double v) { return static_cast<std::int64_t>(std::floor(v / apart_m)); };
  const auto key = [](std::int64_t cx, std::int64_t cy) { return cx * 1000003 + cy; };
  std::vector<Vector2d> places;
  const auto darts = static_cast<std::size_t>((high - low).prod() * darts_per_m2);
  for (std::size_t k = 0; k < darts; ++k) {
    const double x = rng.uniform(low.x(), high.x()), y = rng.uniform(low.y(), high.y());
    const Vector2d p(x, y);
    bool is_free = true;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto cell = cells.find(key(cell_of(x) + dx, cell_of(y) + dy));
        if (cell == cells.end()) continue;
        is_free =
            is_free && std::ranges::none_of(cell->second, [&](const Vector2d& q) { return (q - p).norm() < apart_m; });
      }
    }
    if (!is_free) continue;
    cells[key(cell_of(x), cell_of(y))].push_back(p);
    places.push_back(p);
  }
  return places;
}

/// Back and forth over a square patch, jittered.
std::vector<Vector2d> walk(const SceneRequest& request, Rng& rng) {
  const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(request.num_stations))));
  std::vector<Vector2d> stations;
  for (int k = 0; k < request.num_stations; ++k) {
    const int row = k / side, step = k % side, column = row % 2 == 0 ? step : side - 1 - step;
    const Vector2d jitter(rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15));
    stations.push_back(request.spacing_m * (Vector2d(column, row) + jitter));
  }
  return stations;
}

void add_undergrowth(Mesh& mesh, const Terrain& terrain, const Vector2d& low, const Vector2d& high, Rng& rng) {
  for (const Vector2d& p : scattered(low, high, 1.2, 0.09, rng)) {
    const Vector3d root = terrain.at(p.x(), p.y());
    const double kind = rng.uniform();
    if (kind < 0.6) {
      add_bush(mesh, root, rng.uniform(0.3, 1.1), rng);
    } else if (kind < 0.72) {
      add_stump(mesh, root, rng);
    } else if (kind < 0.82) {
      const double angle = rng.uniform(0, 2 * std::numbers::pi), length = rng.uniform(2, 7);
      const Vector2d q = p + length * Vector2d(std::cos(angle), std::sin(angle));
      add_log(mesh, root, terrain.at(q.x(), q.y()), rng);
    } else {
      add_rock(mesh, root, rng.uniform(0.2, 0.9), rng);
    }
  }
}

}  // namespace

Scene build_forest(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "forest"));
  const std::vector<Vector2d> stations = walk(request, rng);
  Vector2d low = stations.front(), high = low;
  for (const Vector2d& p : stations) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low.array() -= kMargin_m;
  high.array() += kMargin_m;
  const Terrain terrain(rng.uniform(0.0, 0.12), rng.uniform(1.0, 2.2), rng.uniform(30, 55), 4, rng);
  Scene scene;
  constexpr double kGroundStep_m = 0.5, kRoughness_m = 0.025, kTreesApart_m = 1.7;
  add_ground(scene.mesh, terrain, low, high, kGroundStep_m, kRoughness_m, Material::soil, rng);
  for (const Vector2d& p : scattered(low, high, kTreesApart_m, rng.uniform(0.1, 0.16), rng)) {
    add_forest_tree(scene.mesh, terrain.at(p.x(), p.y()), rng.uniform(9, 22), rng);
  }
  add_undergrowth(scene.mesh, terrain, low, high, rng);
  for (const Vector2d& p : stations)
    scene.stations.push_back(terrain.at(p.x(), p.y()) + Vector3d(0, 0, tripod_height_m(rng)));
  scene.people_per_scan = 0.5;
  return scene;
}

}  // namespace isthmus::sim
