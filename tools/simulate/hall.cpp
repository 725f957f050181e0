// An industrial hall: fire walls with gates, columns and trusses in a raster, high racks, machines, crates, pipes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/objects.h"
#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;

struct Hall {
  double length, width, height, raster;
  std::vector<double> partitions;  ///< x of the fire walls
  Mesh mesh;
};

void add_shell(Hall& h) {
  const Transform o = Transform::Identity();
  add_box(h.mesh, o, {-1, -1, -0.5}, {h.length + 1, h.width + 1, 0}, Material::concrete);
  add_box(h.mesh, o, {-1, -1, h.height}, {h.length + 1, h.width + 1, h.height + 0.4}, Material::metal);
  for (const double y : {-0.3, h.width}) {
    std::vector<Opening> gates;
    for (double x = h.raster / 2; x + 4 < h.length; x += 3 * h.raster) gates.push_back({x, x + 4, 2.6, 4.2});
    for (const Opening& g : gates) {
      add_quad(h.mesh, {g.x0, y + 0.15, g.z0}, {g.x1, y + 0.15, g.z0}, {g.x1, y + 0.15, g.z1}, {g.x0, y + 0.15, g.z1},
               Material::glass);
    }
    add_wall(h.mesh, upright({0, y, 0}, 0), h.length, h.height, 0.3, gates, Material::plaster);
  }
  add_box(h.mesh, o, {-0.3, -0.3, 0}, {0, h.width + 0.3, h.height}, Material::plaster);
  add_box(h.mesh, o, {h.length, -0.3, 0}, {h.length + 0.3, h.width + 0.3, h.height}, Material::plaster);
}

void add_frames(Hall& h) {
  for (double x = h.raster; x < h.length - 1; x += h.raster) {
    for (double y = 0; y <= h.width + 0.1; y += h.width / 2) {
      const double at = std::clamp(y, 0.3, h.width - 0.3);
      add_box(h.mesh, upright({x, at, 0}, 0), {-0.2, -0.2, 0}, {0.2, 0.2, h.height}, Material::metal);
    }
    add_box(h.mesh, upright({x, 0, h.height - 1.2}, 0), {-0.08, 0, 0}, {0.08, h.width, 0.12}, Material::metal);
    for (double y = 0; y + 1.5 < h.width; y += 1.5) {
      add_frustum(h.mesh, {x, y, h.height - 1.1}, {x, y + 1.5, h.height}, 0.05, 0.05, 6, Material::metal);
    }
  }
  for (const double y : {0.15 * h.width, 0.6 * h.width}) {
    add_frustum(h.mesh, {0, y, h.height - 1.6}, {h.length, y, h.height - 1.6}, 0.25, 0.25, 14, Material::metal);
  }
}

/// Fire walls across the hall, with a gate in every aisle.
void add_partitions(Hall& h, double aisle, Rng& rng) {
  constexpr double kThick_m = 0.25;
  for (const double x : h.partitions) {
    std::vector<Opening> gates;
    for (double y = aisle / 2; y < h.width; y += aisle) {
      const double half = rng.uniform(1.6, 2.6), middle = y + rng.uniform(-1, 1);
      gates.push_back({middle - half, middle + half, 0, rng.uniform(3, 4.5)});
    }
    add_wall(h.mesh, upright({x + kThick_m, 0, 0}, kPi / 2), h.width, h.height, kThick_m, gates, Material::plaster);
  }
}

/// Pallet racks: uprights, beams, and pallets with goods on some.
void add_rack(Hall& h, const Transform& f, int bays, double height, Rng& rng) {
  constexpr double kBay_m = 2.7, kDepth_m = 1.1;
  for (int k = 0; k <= bays; ++k) {
    for (const double y : {0.0, kDepth_m - 0.1})
      add_box(h.mesh, f, {k * kBay_m, y, 0}, {k * kBay_m + 0.1, y + 0.1, height}, Material::metal);
  }
  for (double z = 0.1; z < height - 1; z += 1.6) {
    for (const double y : {0.0, kDepth_m - 0.06}) {
      if (z > 0.2) add_box(h.mesh, f, {0.1, y, z - 0.12}, {bays * kBay_m, y + 0.06, z}, Material::paint_red);
    }
    for (int k = 0; k < 2 * bays; ++k) {
      const double x = 0.2 + 0.5 * kBay_m * k, tall = rng.uniform(0.3, 1.3);
      if (chance(rng, 0.85))
        add_box(h.mesh, f, {x, 0.05, z + 0.01}, {x + rng.uniform(0.8, 1.15), kDepth_m - 0.05, z + tall},
                Material::paper);
    }
  }
}

void add_machine(Hall& h, const Transform& f, Rng& rng) {
  const double l = rng.uniform(1.0, 3.0), w = rng.uniform(0.7, 1.5), tall = rng.uniform(0.9, 2.2);
  add_box(h.mesh, f, {-l, -w, 0}, {l, w, tall}, Material::metal);
  add_box(h.mesh, f, {-0.4 * l, -0.6 * w, tall}, {0.7 * l, 0.5 * w, tall + rng.uniform(0.3, 1.2)},
          Material::paint_white);
  add_frustum(h.mesh, f * Vector3d(0.8 * l, 0, tall), f * Vector3d(0.8 * l, 0, h.height - 1.6), 0.15, 0.15, 10,
              Material::metal);
  add_box(h.mesh, f, {-l - 0.6, -0.3, 0}, {-l - 0.1, 0.3, 1.3}, Material::dark_metal);
}

void add_contents(Hall& h, double aisle, Rng& rng) {
  for (double y = aisle; y + 2 < h.width; y += aisle) {
    for (double x = 3; x + 8 < h.length;) {
      const int bays = 2 + static_cast<int>(rng.below(4));
      const double room = bays * 2.7, kind = rng.uniform();
      if (x + room > h.length - 2) break;
      const auto wall = std::ranges::find_if(h.partitions, [&](double p) { return x - 1.0 < p && p < x + room + 1.0; });
      if (wall != h.partitions.end()) {
        x = *wall + 1.3;
        continue;
      }
      if (kind < 0.6) {
        add_rack(h, upright({x, y - 0.55, 0}, 0), bays, rng.uniform(3.0, std::max(3.2, h.height - 2)), rng);
      } else if (kind < 0.85) {
        add_machine(h, upright({x + room / 2, y, 0}, (chance(rng, 0.5) ? 0 : kPi) + rng.uniform(-0.1, 0.1)), rng);
      } else {
        for (int k = 0; k < 4; ++k) {
          add_box(h.mesh, upright({x + rng.uniform(0, room), y + rng.uniform(-1, 1), 0}, rng.uniform(0, 3)),
                  {-0.6, -0.4, 0}, {0.6, 0.4, rng.uniform(0.4, 1.8)}, Material::wood);
        }
      }
      x += room + rng.uniform(2.0, 4.5);
    }
  }
}

}  // namespace

Scene build_hall(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "hall"));
  const int columns = std::max(2, static_cast<int>(std::ceil(std::sqrt(1.6 * request.num_stations))));
  const int rows = (request.num_stations + columns - 1) / columns;
  const double aisle = 0.75 * request.spacing_m;
  Hall h{(columns + 0.5) * request.spacing_m,
         std::max(2, rows + 1) * aisle,
         rng.uniform(6.5, 10),
         rng.uniform(5, 7),
         {},
         {}};
  for (int c = 0; c + 1 < columns; ++c) h.partitions.push_back((c + 1.25) * request.spacing_m + rng.uniform(-2, 2));
  add_shell(h);
  add_frames(h);
  add_partitions(h, aisle, rng);
  add_contents(h, aisle, rng);
  Scene scene;
  for (int k = 0; k < request.num_stations; ++k) {
    const int row = k / columns, step = k % columns, column = row % 2 == 0 ? step : columns - 1 - step;
    const double x = (column + 0.75) * request.spacing_m + rng.uniform(-1.0, 1.0),
                 y = (row + 0.5) * aisle + rng.uniform(-0.8, 0.8);
    scene.stations.emplace_back(x, y, tripod_height_m(rng));
  }
  scene.mesh = std::move(h.mesh);
  scene.people_per_scan = 2;
  return scene;
}

}  // namespace isthmus::sim
