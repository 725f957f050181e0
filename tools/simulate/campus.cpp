// A campus on a slope: detached buildings of different footprints in blocks of lawn, lanes between them, trees, cars,
// benches. Stations stand at the corners and along the sides of the blocks.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/buildings.h"
#include "simulate/objects.h"
#include "simulate/plants.h"
#include "simulate/scene.h"
#include "simulate/terrain.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;

struct Campus {
  double spacing_m;
  int blocks_x, blocks_y;  ///< a block is two spacings wide
  Terrain terrain;
  Mesh mesh;
  std::vector<Wing> taken;  ///< footprints, common frame, for keeping trees out of houses
  [[nodiscard]] double width() const { return 2 * spacing_m * blocks_x; }
  [[nodiscard]] double depth() const { return 2 * spacing_m * blocks_y; }
  [[nodiscard]] bool is_taken(double x, double y, double margin) const {
    return std::ranges::any_of(taken, [&](const Wing& w) {
      return x > w.x0 - margin && x < w.x1 + margin && y > w.y0 - margin && y < w.y1 + margin;
    });
  }
};

struct Footprint {
  std::vector<Vector2d> outline;  ///< counter-clockwise
  std::vector<Wing> wings;
};

/// A bar, an L, a T or a U of about w x d, centred, whose wings are `wing` deep.
Footprint random_footprint(double w, double d, double wing, Rng& rng) {
  const double x = w / 2, y = d / 2;
  const auto kind = d < wing + 6 ? 0 : rng.below(4);
  if (kind == 0)
    return {{{-x, -wing / 2}, {x, -wing / 2}, {x, wing / 2}, {-x, wing / 2}}, {{-x, x, -wing / 2, wing / 2}}};
  if (kind == 1) {
    return {{{-x, -y}, {x, -y}, {x, -y + wing}, {-x + wing, -y + wing}, {-x + wing, y}, {-x, y}},
            {{-x, x, -y, -y + wing}, {-x, -x + wing, -y + wing, y}}};
  }
  if (kind == 2) {
    const double a = rng.uniform(-0.2, 0.2) * w - wing / 2, b = a + wing;
    return {{{-x, -y}, {x, -y}, {x, -y + wing}, {b, -y + wing}, {b, y}, {a, y}, {a, -y + wing}, {-x, -y + wing}},
            {{-x, x, -y, -y + wing}, {a, b, -y + wing, y}}};
  }
  const double right = y * rng.uniform(0.2, 1.0);
  return {{{-x, -y},
           {x, -y},
           {x, right},
           {x - wing, right},
           {x - wing, -y + wing},
           {-x + wing, -y + wing},
           {-x + wing, y},
           {-x, y}},
          {{-x, x, -y, -y + wing}, {x - wing, x, -y + wing, right}, {-x, -x + wing, -y + wing, y}}};
}

/// One building in the middle of block (i, j), turned by quarter turns and a little more, sometimes none (a park).
void add_block(Campus& campus, int i, int j, Rng& rng) {
  const double room = 2 * campus.spacing_m - 13;  // the rest is lane
  const Vector2d centre = campus.spacing_m * Vector2d(2 * i + 1, 2 * j + 1);
  const double w = room * rng.uniform(0.65, 0.95), d = room * rng.uniform(0.55, 0.95),
               wing = std::min(rng.uniform(9, 13), 0.45 * w);
  const Footprint footprint = random_footprint(w, d, wing, rng);
  const double yaw = kPi / 2 * static_cast<double>(rng.below(4)) + rng.uniform(-0.06, 0.06);
  const FacadeStyle style = random_style(rng);
  const int floors = 2 + static_cast<int>(rng.below(3));
  const bool gable = chance(rng, 0.3);
  double z = -1e9;
  for (const Vector2d& corner : footprint.outline) {
    const Vector2d p = centre + Eigen::Rotation2Dd(yaw) * corner;
    z = std::max(z, campus.terrain.height_m(p.x(), p.y()));
  }
  const Transform frame = upright({centre.x(), centre.y(), z + 0.1}, yaw);
  add_building(campus.mesh, frame, footprint.outline, footprint.wings, floors, 5.0, style, gable, rng);
  for (const Wing& part : footprint.wings) {
    Wing box{1e9, -1e9, 1e9, -1e9};
    for (const Vector2d& c : {Vector2d(part.x0, part.y0), Vector2d(part.x1, part.y0), Vector2d(part.x1, part.y1),
                              Vector2d(part.x0, part.y1)}) {
      const Vector2d p = centre + Eigen::Rotation2Dd(yaw) * c;
      box = {std::min(box.x0, p.x()), std::max(box.x1, p.x()), std::min(box.y0, p.y()), std::max(box.y1, p.y())};
    }
    campus.taken.push_back(box);
  }
}

/// Paved strips a hand above the lawn along the lanes, one every two spacings each way.
void add_lanes(Campus& campus, std::vector<Lane>& lanes, Rng& rng) {
  constexpr double kPiece_m = 2.0, kKerb_m = 0.08;
  const auto strip = [&](const Vector2d& from, const Vector2d& to, double half) {
    const Vector2d along = (to - from).normalized(), left(-along.y(), along.x());
    const int pieces = std::max(1, static_cast<int>((to - from).norm() / kPiece_m));
    const Vector2d step = (to - from) / pieces;
    const auto at = [&](int k, double t) -> Vector3d {
      const Vector2d p = from + k * step + t * left;
      return campus.terrain.at(p.x(), p.y()) + Vector3d(0, 0, kKerb_m);
    };
    for (int k = 0; k < pieces; ++k) {
      add_quad(campus.mesh, at(k, -half), at(k + 1, -half), at(k + 1, half), at(k, half), Material::asphalt);
      const Vector3d down(0, 0, -3 * kKerb_m);
      add_quad(campus.mesh, at(k, -half) + down, at(k + 1, -half) + down, at(k + 1, -half), at(k, -half),
               Material::concrete);
      add_quad(campus.mesh, at(k + 1, half) + down, at(k, half) + down, at(k, half), at(k + 1, half),
               Material::concrete);
    }
    for (int k = 0; k + 12 < pieces; k += 12) lanes.push_back({at(k, 0), at(k + 12, 0)});
  };
  for (int i = 0; i <= campus.blocks_x; ++i) {
    const double x = 2 * campus.spacing_m * i + rng.uniform(-0.5, 0.5);
    strip({x, -2 * campus.spacing_m}, {x, campus.depth() + 2 * campus.spacing_m}, rng.uniform(1.5, 2.6));
  }
  for (int j = 0; j <= campus.blocks_y; ++j) {
    const double y = 2 * campus.spacing_m * j + rng.uniform(-0.5, 0.5);
    strip({-2 * campus.spacing_m, y}, {campus.width() + 2 * campus.spacing_m, y}, rng.uniform(1.5, 2.6));
  }
}

void add_outdoor_things(Campus& campus, Rng& rng) {
  constexpr double kPerSquareMetre = 0.011;
  const double margin_m = 2 * campus.spacing_m;
  const double area = (campus.width() + 2 * margin_m) * (campus.depth() + 2 * margin_m);
  const auto count = static_cast<int>(area * kPerSquareMetre);
  for (int k = 0; k < count; ++k) {
    const double x = rng.uniform(-margin_m, campus.width() + margin_m),
                 y = rng.uniform(-margin_m, campus.depth() + margin_m);
    const double yaw = rng.uniform(0, 2 * kPi), kind = rng.uniform(), lane = 2 * campus.spacing_m;
    const auto off_lane = [lane](double v) { return std::abs(v - lane * std::round(v / lane)); };
    if (campus.is_taken(x, y, kind < 0.5 ? 3.5 : 1.5)) continue;
    const bool on_lane = std::min(off_lane(x), off_lane(y)) < 3.2;
    const Transform frame = upright(campus.terrain.at(x, y), yaw);
    if (on_lane) continue;
    if (kind < 0.5) {
      add_town_tree(campus.mesh, frame.translation(), rng.uniform(5, 13), rng);
    } else if (kind < 0.68) {
      add_bush(campus.mesh, frame.translation(), rng.uniform(0.4, 1.3), rng);
    } else if (kind < 0.76) {
      add_bench(campus.mesh, frame);
    } else if (kind < 0.83) {
      add_lamp_post(campus.mesh, frame, rng.uniform(3.5, 5), rng);
    } else if (kind < 0.88) {
      add_bin(campus.mesh, frame, rng);
    } else if (kind < 0.92) {
      add_rock(campus.mesh, frame.translation(), rng.uniform(0.3, 0.9), rng);
    } else if (kind < 0.95) {
      add_traffic_sign(campus.mesh, frame, rng);
    }
  }
}

/// Rows of cars parked beside the lanes.
void add_parked_cars(Campus& campus, Rng& rng) {
  const int rows = 2 + 2 * campus.blocks_x * campus.blocks_y;
  for (int k = 0; k < rows; ++k) {
    const double x0 =
        2 * campus.spacing_m * static_cast<double>(rng.below(static_cast<std::uint64_t>(campus.blocks_x) + 1)) +
        (chance(rng, 0.5) ? 5.5 : -5.5);
    const double y0 = rng.uniform(-15, campus.depth());
    const auto cars = 3 + rng.below(6);
    for (std::uint64_t c = 0; c < cars; ++c) {
      const double y = y0 + 2.6 * static_cast<double>(c), yaw = (chance(rng, 0.8) ? 0 : kPi) + rng.uniform(-0.05, 0.05);
      if (!campus.is_taken(x0, y, 2.8) && chance(rng, 0.75))
        add_car(campus.mesh, upright(campus.terrain.at(x0, y), yaw), rng);
    }
  }
}

/// Rows of the lattice back and forth; where row and column are both odd stands a building.
std::vector<Vector2d> walk(const Campus& campus, int num_stations, Rng& rng) {
  std::vector<Vector2d> stations;
  const int columns = 2 * campus.blocks_x;
  for (int row = 0; static_cast<int>(stations.size()) < num_stations; ++row) {
    for (int step = 0; step <= columns && static_cast<int>(stations.size()) < num_stations; ++step) {
      const int column = row % 4 < 2 ? step : columns - step;
      if (row % 2 == 1 && column % 2 == 1) continue;
      const Vector2d jitter(rng.uniform(-2.5, 2.5), rng.uniform(-2.5, 2.5));
      stations.push_back(campus.spacing_m * Vector2d(column, row) + jitter);
    }
  }
  return stations;
}

Campus plan_campus(const SceneRequest& request, Rng& rng) {
  // A lattice of (2 bx + 1) x (2 by + 1) places less the bx x by in the middle of the blocks.
  const auto places = [](int bx, int by) { return (2 * bx + 1) * (2 * by + 1) - bx * by; };
  int bx = 1, by = 1;
  while (places(bx, by) < request.num_stations) ++(bx <= by ? bx : by);
  return {request.spacing_m, bx, by, Terrain(rng.uniform(0.01, 0.05), 0.6, 60, 2, rng), {}, {}};
}

}  // namespace

Scene build_campus(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "campus"));
  Campus campus = plan_campus(request, rng);
  Scene scene;
  constexpr double kGroundStep_m = 1.0, kRoughness_m = 0.015;
  const double margin_m = 2 * request.spacing_m + 10;
  add_ground(campus.mesh, campus.terrain, {-margin_m, -margin_m},
             {campus.width() + margin_m, campus.depth() + margin_m}, kGroundStep_m, kRoughness_m, Material::grass, rng);
  // One more block on every side, so that the outer stations have something to see.
  for (int i = -1; i <= campus.blocks_x; ++i) {
    for (int j = -1; j <= campus.blocks_y; ++j) add_block(campus, i, j, rng);
  }
  add_lanes(campus, scene.lanes, rng);
  add_outdoor_things(campus, rng);
  add_parked_cars(campus, rng);
  for (const Vector2d& p : walk(campus, request.num_stations, rng)) {
    scene.stations.push_back(campus.terrain.at(p.x(), p.y()) + Vector3d(0, 0, tripod_height_m(rng)));
  }
  scene.mesh = std::move(campus.mesh);
  scene.people_per_scan = 2;
  return scene;
}

}  // namespace isthmus::sim
