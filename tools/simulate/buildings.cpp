#include "simulate/buildings.h"

#include <algorithm>
#include <cmath>

#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kRoom_m = 2.6;  ///< how deep the rooms behind the panes are

/// Draws in the frame of one facade.
struct FacadeFrame {
  Mesh& mesh;
  const Transform& world;
  [[nodiscard]] Vector3d at(double x, double y, double z) const { return world * Vector3d(x, y, z); }
  /// A piece of wall parallel to the facade, seen from outside (-y).
  void front(double x0, double x1, double z0, double z1, double y, Material m) const {
    if (x1 > x0 && z1 > z0) add_quad(mesh, at(x0, y, z0), at(x1, y, z0), at(x1, y, z1), at(x0, y, z1), m);
  }
  void box(double x0, double x1, double y0, double y1, double z0, double z1, Material m) const {
    add_box(mesh, world, {x0, y0, z0}, {x1, y1, z1}, m);
  }
};

/// The four sides of a hole of the given depth.
void add_reveal(const FacadeFrame& f, const Opening& o, double depth, Material m) {
  add_quad(f.mesh, f.at(o.x0, 0, o.z0), f.at(o.x1, 0, o.z0), f.at(o.x1, depth, o.z0), f.at(o.x0, depth, o.z0), m);
  add_quad(f.mesh, f.at(o.x0, depth, o.z1), f.at(o.x1, depth, o.z1), f.at(o.x1, 0, o.z1), f.at(o.x0, 0, o.z1), m);
  add_quad(f.mesh, f.at(o.x0, 0, o.z0), f.at(o.x0, depth, o.z0), f.at(o.x0, depth, o.z1), f.at(o.x0, 0, o.z1), m);
  add_quad(f.mesh, f.at(o.x1, depth, o.z0), f.at(o.x1, 0, o.z0), f.at(o.x1, 0, o.z1), f.at(o.x1, depth, o.z1), m);
}

void add_balcony(const FacadeFrame& f, const Opening& o, double floor_z, Rng& rng) {
  const double x0 = o.x0 - 0.4, x1 = o.x1 + 0.4, reach = rng.uniform(0.8, 1.4);
  f.box(x0, x1, -reach, 0, floor_z - 0.15, floor_z, Material::concrete);
  if (chance(rng, 0.4)) {
    f.box(x0, x1, -reach, -reach + 0.06, floor_z, floor_z + 1.0, Material::concrete);
  } else {
    const int bars = static_cast<int>((x1 - x0) / 0.15);
    for (int k = 0; k <= bars; ++k) {
      const double x = x0 + (x1 - x0 - 0.02) * k / bars;
      f.box(x, x + 0.02, -reach, -reach + 0.02, floor_z, floor_z + 1.0, Material::dark_metal);
    }
    f.box(x0, x1, -reach, -reach + 0.04, floor_z + 1.0, floor_z + 1.04, Material::dark_metal);
  }
  for (const double x : {x0, x1 - 0.03})
    f.box(x, x + 0.03, -reach, 0, floor_z + 0.96, floor_z + 1.04, Material::dark_metal);
}

/// Pane, frame bars, sometimes a blind behind or a plant before it.
void add_window_in(const FacadeFrame& f, const Opening& o, const FacadeStyle& style, Rng& rng) {
  const double y = style.recess_m;
  add_reveal(f, o, y, style.wall);
  f.front(o.x0, o.x1, o.z0, o.z1, y, Material::glass);
  const double middle = (o.x0 + o.x1) / 2, bar = 0.05;
  f.front(o.x0, o.x0 + bar, o.z0, o.z1, y - 0.03, Material::paint_white);
  f.front(o.x1 - bar, o.x1, o.z0, o.z1, y - 0.03, Material::paint_white);
  f.front(o.x0, o.x1, o.z0, o.z0 + bar, y - 0.03, Material::paint_white);
  f.front(o.x0, o.x1, o.z1 - bar, o.z1, y - 0.03, Material::paint_white);
  f.front(middle - bar / 2, middle + bar / 2, o.z0, o.z1, y - 0.03, Material::paint_white);
  const bool blind = chance(rng, style.blinds), pots = chance(rng, 0.06);
  const double drawn = rng.uniform(0.3, 1.0) * (o.z1 - o.z0);
  if (blind) f.front(o.x0, o.x1, o.z1 - drawn, o.z1, y + 0.06, Material::cloth_light);
  if (pots) f.box(o.x0 + 0.1, o.x1 - 0.1, -0.2, -0.01, o.z0 - 0.05, o.z0 + 0.18, Material::ceramic);
  f.box(o.x0 - 0.05, o.x1 + 0.05, -0.06, 0.0, o.z0 - 0.05, o.z0, Material::stone);
}

void add_door_in(const FacadeFrame& f, const Opening& o, double step_z, Rng& rng) {
  const double depth = rng.uniform(0.25, 0.9);
  add_reveal(f, o, depth, Material::stone);
  f.front(o.x0, o.x1, o.z0, o.z1, depth, chance(rng, 0.5) ? Material::wood : Material::dark_wood);
  f.box(o.x0 - 0.15, o.x1 + 0.15, -0.35, 0, step_z - 0.6, step_z, Material::stone);
  if (chance(rng, 0.4)) f.box(o.x0 - 0.3, o.x1 + 0.3, -1.1, 0, o.z1 + 0.1, o.z1 + 0.22, Material::concrete);
}

/// A strip of wall of one floor with its openings, which are sorted and share no x.
void add_strip(const FacadeFrame& f, double length, double z0, double z1, const std::vector<Opening>& openings,
               Material wall) {
  double x = 0;
  for (const Opening& o : openings) {
    f.front(x, o.x0, z0, z1, 0, wall);
    f.front(o.x0, o.x1, z0, o.z0, 0, wall);
    f.front(o.x0, o.x1, o.z1, z1, 0, wall);
    x = o.x1;
  }
  f.front(x, length, z0, z1, 0, wall);
}

void add_ground_floor(const FacadeFrame& f, double length, const FacadeStyle& style, bool has_door, Rng& rng) {
  const int bays = std::max(1, static_cast<int>((length - 0.6) / style.bay_m));
  const int door = has_door ? static_cast<int>(rng.below(static_cast<std::uint64_t>(bays))) : -1;
  std::vector<Opening> openings;
  for (int k = 0; k < bays; ++k) {
    const double x = length * (k + 0.5) / bays;
    if (k == door) {
      const double half = std::min(rng.uniform(0.5, 0.9), 0.45 * style.bay_m);
      openings.push_back({x - half, x + half, 0.15, 2.4});
      add_door_in(f, openings.back(), 0.15, rng);
    } else {
      const double half = style.shops ? 0.43 * length / bays : style.window_m / 2;
      openings.push_back({x - half, x + half, style.shops ? 0.5 : style.sill_m,
                          style.shops ? style.floor_height_m - 0.5 : style.head_m});
      add_window_in(f, openings.back(), style, rng);
      if (style.shops && chance(rng, 0.3))
        f.box(x - half, x + half, -1.2, -0.02, style.floor_height_m - 0.45, style.floor_height_m - 0.35,
              Material::cloth_light);
    }
  }
  if (style.shops && chance(rng, 0.7)) {
    const double x = rng.uniform(0.1, 0.4) * length, end = std::min(length - 0.2, x + rng.uniform(1.5, 5.0));
    f.box(x, end, -0.12, 0, style.floor_height_m - 0.3, style.floor_height_m + 0.25, Material::paint_red);
  }
  add_strip(f, length, 0, style.floor_height_m, openings, style.wall);
}

void add_upper_floor(const FacadeFrame& f, double length, double z, const FacadeStyle& style, Rng& rng) {
  const int bays = std::max(1, static_cast<int>((length - 0.6) / style.bay_m));
  std::vector<Opening> openings;
  for (int k = 0; k < bays; ++k) {
    const double x = length * (k + 0.5) / bays;
    const bool balcony = chance(rng, style.balconies);
    openings.push_back(
        {x - style.window_m / 2, x + style.window_m / 2, z + (balcony ? 0.05 : style.sill_m), z + style.head_m});
    add_window_in(f, openings.back(), style, rng);
    if (balcony) add_balcony(f, openings.back(), z, rng);
    if (!balcony && chance(rng, 0.03))
      f.box(x - 0.4, x + 0.4, -0.45, -0.05, z + 0.2, z + 0.8, Material::metal);  // air conditioner
  }
  add_strip(f, length, z, z + style.floor_height_m, openings, style.wall);
}

void add_roof(Mesh& mesh, const Transform& world, const Wing& w, double z, bool gable) {
  const Transform f = world;
  if (!gable) {
    add_quad(mesh, f * Vector3d(w.x0, w.y0, z), f * Vector3d(w.x1, w.y0, z), f * Vector3d(w.x1, w.y1, z),
             f * Vector3d(w.x0, w.y1, z), Material::gravel);
    return;
  }
  const double over = 0.4, middle = (w.y0 + w.y1) / 2, rise = 0.35 * (w.y1 - w.y0),
               eave = z - over * rise / (middle - w.y0);
  const Vector3d a = f * Vector3d(w.x0, w.y0 - over, eave), b = f * Vector3d(w.x1, w.y0 - over, eave);
  const Vector3d c = f * Vector3d(w.x1, middle, z + rise), d = f * Vector3d(w.x0, middle, z + rise);
  const Vector3d e = f * Vector3d(w.x1, w.y1 + over, eave), g = f * Vector3d(w.x0, w.y1 + over, eave);
  add_quad(mesh, a, b, c, d, Material::brick);
  add_quad(mesh, d, c, e, g, Material::brick);
  add_triangle(mesh, f * Vector3d(w.x1, w.y0, z), f * Vector3d(w.x1, w.y1, z), c, Material::plaster);
  add_triangle(mesh, f * Vector3d(w.x0, w.y1, z), f * Vector3d(w.x0, w.y0, z), d, Material::plaster);
}

}  // namespace

FacadeStyle random_style(Rng& rng) {
  constexpr Material kWalls[] = {Material::plaster, Material::brick, Material::stone, Material::concrete};
  FacadeStyle s;
  s.wall = kWalls[rng.below(4)];
  s.floor_height_m = rng.uniform(2.8, 3.6);
  s.bay_m = rng.uniform(1.9, 3.4);
  s.window_m = s.bay_m * rng.uniform(0.4, 0.65);
  s.sill_m = rng.uniform(0.6, 1.0);
  s.head_m = s.floor_height_m - rng.uniform(0.3, 0.7);
  s.recess_m = rng.uniform(0.1, 0.35);
  s.balconies = chance(rng, 0.35) ? rng.uniform(0.1, 0.5) : 0.0;
  s.blinds = rng.uniform(0.1, 0.4);
  s.shops = chance(rng, 0.35);
  s.plinth_m = rng.uniform(0.3, 0.8);
  return s;
}

void add_facade(Mesh& mesh, const Transform& world_from_facade, double length_m, int floors, double foot_m,
                const FacadeStyle& style, bool has_door, Rng& rng) {
  const FacadeFrame f{mesh, world_from_facade};
  const double height = floors * style.floor_height_m, inner = std::min(kRoom_m, 0.45 * length_m);
  f.front(0, length_m, -foot_m, 0, 0, style.wall);
  add_ground_floor(f, length_m, style, has_door, rng);
  for (int k = 1; k < floors; ++k) add_upper_floor(f, length_m, k * style.floor_height_m, style, rng);
  // What one sees through the panes: floors, ceilings and back walls of rooms.
  f.front(0, length_m, 0, height, inner, Material::plaster);
  for (int k = 0; k <= floors; ++k) {
    const double z = k * style.floor_height_m;
    f.box(0.02, length_m - 0.02, style.recess_m + 0.1, inner, z - 0.3, z, Material::carpet);
  }
  for (double x = style.bay_m; x < length_m - 1; x += style.bay_m * 2) {
    f.box(x - 0.05, x + 0.05, style.recess_m + 0.1, inner, 0, height, Material::plaster);
  }
  f.box(-0.02, length_m + 0.02, -0.04, 0, -foot_m, style.plinth_m * (has_door ? 0.28 : 1.0), Material::stone);
  f.box(-0.05, length_m + 0.05, -0.25, 0, height - 0.05, height + 0.35, style.wall);
  const double pipe = chance(rng, 0.5) ? 0.15 : length_m - 0.15;
  add_frustum(mesh, f.at(pipe, -0.1, -foot_m), f.at(pipe, -0.1, height), 0.05, 0.05, 8, Material::metal);
}

void add_building(Mesh& mesh, const Transform& world_from_building, const std::vector<Vector2d>& outline,
                  const std::vector<Wing>& wings, int floors, double foot_m, const FacadeStyle& style, bool gable,
                  Rng& rng) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector2d a = outline[k], along = outline[(k + 1) % outline.size()] - a;
    const Transform facade = world_from_building * upright({a.x(), a.y(), 0}, std::atan2(along.y(), along.x()));
    add_facade(mesh, facade, along.norm(), floors, foot_m, style, k == 0 || chance(rng, 0.3), rng);
  }
  for (const Wing& wing : wings) add_roof(mesh, world_from_building, wing, floors * style.floor_height_m, gable);
}

}  // namespace isthmus::sim
