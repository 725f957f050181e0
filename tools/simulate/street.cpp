// A street of terraced houses with pavements, parked cars, trees and side streets; long walks go once around a block,
// so that the survey closes on itself.
//
// Street coordinates: s along the axis, t to its left, metres.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/buildings.h"
#include "simulate/objects.h"
#include "simulate/path.h"
#include "simulate/plants.h"
#include "simulate/scene.h"
#include "simulate/terrain.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kKerb_m = 0.13;
constexpr double kHouseDepth_m = 12;
constexpr double kSideLength_m = 48;  ///< of a side street, from the building line

/// A street that leaves the axis at s towards +t (side = 1) or -t (side = -1).
struct SideStreet {
  double s = 0, side = 1, half_width = 4;
};

struct Street {
  Path path;
  Terrain terrain;
  double road_half, pavement;  ///< widths from the axis: road edge; then the pavement
  bool is_loop = false;
  std::vector<SideStreet> sides;
  Mesh mesh;

  [[nodiscard]] double building_line() const { return road_half + pavement; }
  [[nodiscard]] double inner_reach() const {
    return is_loop ? building_line() + 14 : building_line() + kSideLength_m + 14;
  }
  [[nodiscard]] const SideStreet* side_street_near(double s, double side, double margin) const {
    for (const SideStreet& x : sides) {
      if (x.side == side && std::abs(x.s - s) < x.half_width + margin) return &x;
    }
    return nullptr;
  }
  [[nodiscard]] Vector3d ground(double s, double t, bool on_pavement) const {
    const Vector2d p = path.at(s, t);
    return {p.x(), p.y(), terrain.height_m(p.x(), p.y()) + (on_pavement ? kKerb_m : 0.0)};
  }
  /// A frame on the ground at (s, t), x along the street.
  [[nodiscard]] Transform frame(double s, double t, bool on_pavement, double yaw_rad = 0) const {
    return upright(ground(s, t, on_pavement), path.heading_rad(s) + yaw_rad);
  }
};

/// Road, kerbs and pavements as strips across the axis; the kerbs sink where a side street joins.
void add_street_ground(Street& street) {
  constexpr double kAlong_m = 1.0, kAcross_m = 2.5, kKerbWidth_m = 0.02;
  std::vector<std::pair<double, bool>> columns;  // t, on the pavement
  const auto side_columns = [&](double side, double reach) {
    std::vector<std::pair<double, bool>> out;
    for (double t = 0.5; t < street.road_half - 0.5; t += kAcross_m / 2) out.emplace_back(side * t, false);
    out.emplace_back(side * street.road_half, false);
    out.emplace_back(side * (street.road_half + kKerbWidth_m), true);
    for (double t = street.road_half + kAcross_m; t < reach; t += kAcross_m) out.emplace_back(side * t, true);
    return out;
  };
  columns = side_columns(-1, street.building_line() + kSideLength_m + 14);
  std::reverse(columns.begin(), columns.end());
  for (const auto& column : side_columns(1, street.inner_reach())) columns.push_back(column);
  const double ends = street.is_loop ? 0 : 40;
  const int rows = static_cast<int>((street.path.length_m() + 2 * ends) / kAlong_m) + 1;
  const auto first = static_cast<std::uint32_t>(street.mesh.vertices.size());
  const auto width = static_cast<std::uint32_t>(columns.size());
  for (int r = 0; r <= rows; ++r) {
    const double s = -ends + r * kAlong_m;
    for (const auto& [t, pavement] : columns) {
      const bool joins = street.side_street_near(s, t > 0 ? 1.0 : -1.0, -1.2) != nullptr;
      street.mesh.vertices.push_back(street.ground(s, t, pavement && !joins).cast<float>());
    }
  }
  for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(rows); ++r) {
    for (std::uint32_t c = 0; c + 1 < width; ++c) {
      const std::uint32_t a = first + r * width + c, b = a + width;
      const Material m = std::abs(columns[c].first) <= street.road_half ? Material::asphalt : Material::concrete;
      street.mesh.triangles.push_back({a, b, b + 1});
      street.mesh.triangles.push_back({a, b + 1, a + 1});
      street.mesh.materials.insert(street.mesh.materials.end(), 2, m);
    }
  }
}

/// A house whose front runs from `a` to `b`, the street on its right; returns nothing to know.
void add_house(Street& street, const Vector2d& a, const Vector2d& b, Rng& rng) {
  const Vector2d along = b - a;
  const double width = along.norm(), setback = chance(rng, 0.25) ? rng.uniform(0.4, 1.8) : 0.0;
  const double z = std::max(street.terrain.height_m(a.x(), a.y()), street.terrain.height_m(b.x(), b.y())) + kKerb_m;
  const Transform frame = upright({a.x(), a.y(), z}, std::atan2(along.y(), along.x())) * upright({0, setback, 0}, 0);
  const Wing wing{0, width, 0, kHouseDepth_m};
  const FacadeStyle style = random_style(rng);
  const int floors = 2 + static_cast<int>(rng.below(4));
  add_building(street.mesh, frame, {{0, 0}, {width, 0}, {width, kHouseDepth_m}, {0, kHouseDepth_m}}, {wing}, floors,
               2.5, style, chance(rng, 0.5), rng);
}

/// Houses wall to wall along one side of the axis, with gaps where side streets leave.
void add_terrace(Street& street, double side, Rng& rng) {
  constexpr double kNarrowest_m = 5;
  const double t = side * street.building_line(), end = street.path.length_m() + (street.is_loop ? 0 : 25);
  double s = street.is_loop ? 0 : -25;
  while (s < end - kNarrowest_m) {
    double width = rng.uniform(8, 18);
    for (const SideStreet& x : street.sides) {
      if (x.side != side) continue;
      const double low = x.s - x.half_width, high = x.s + x.half_width;
      if (s >= low - kNarrowest_m && s < high) {
        s = high;
      } else if (s < low && s + width > low - kNarrowest_m) {
        width = low - s;
      }
    }
    width = std::min(width, end - s);
    const Vector2d a = street.path.at(s, t), b = street.path.at(s + width, t);
    if (side > 0) {
      add_house(street, a, b, rng);
    } else {
      add_house(street, b, a, rng);
    }
    s += width;
  }
}

/// Houses on both sides of a side street behind the corner houses, and one across its end.
void add_side_street_houses(Street& street, const SideStreet& x, Rng& rng) {
  const double first = street.building_line() + kHouseDepth_m + 1, last = street.building_line() + kSideLength_m;
  const Vector2d origin = street.path.at(x.s), out = (street.path.at(x.s, x.side) - origin).normalized();
  const Vector2d right(out.y(), -out.x());
  const auto at = [&](double along, double across) -> Vector2d { return origin + along * out + across * right; };
  for (const double side : {-1.0, 1.0}) {
    for (double from = first; from < last - 6;) {
      const double to = std::min(last, from + rng.uniform(9, 18));
      const Vector2d a = at(from, side * x.half_width), b = at(to, side * x.half_width);
      if (side < 0) {
        add_house(street, a, b, rng);
      } else {
        add_house(street, b, a, rng);
      }
      from = to;
    }
  }
  add_house(street, at(last, -x.half_width - 5), at(last, x.half_width + 5), rng);
  for (double along = street.building_line() + 4; along < last - 6; along += rng.uniform(5.2, 11)) {
    const double side = chance(rng, 0.5) ? 1.0 : -1.0;
    const Vector2d p = at(along, side * (x.half_width - 1.2));
    if (chance(rng, 0.6)) {
      add_car(street.mesh, upright(street.terrain.at(p.x(), p.y()), std::atan2(out.y(), out.x())), rng);
    } else if (chance(rng, 0.4)) {
      add_town_tree(street.mesh, street.terrain.at(p.x(), p.y()), rng.uniform(4, 8), rng);
    }
  }
}

void add_parked_cars(Street& street, double side, Rng& rng) {
  const double share = rng.uniform(0.35, 0.75);
  for (double s = 1; s < street.path.length_m(); s += rng.uniform(5.1, 6.5)) {
    const bool is_taken = chance(rng, share), backwards = chance(rng, 0.15);
    if (!is_taken || street.side_street_near(s, side, 5)) continue;
    const double yaw = ((side > 0) != backwards ? kPi : 0.0) + rng.uniform(-0.03, 0.03);
    add_car(street.mesh, street.frame(s, side * (street.road_half - 1.05), false, yaw), rng);
  }
}

/// Trees, lamps, benches, bins, signs and bollards of one pavement.
void add_pavement_things(Street& street, double side, Rng& rng) {
  const bool has_trees = chance(rng, 0.7);
  const double kerb = side * (street.road_half + 0.55), wall = side * (street.building_line() - 0.5);
  double lamp_in = rng.uniform(5, 25);
  for (double s = rng.uniform(0, 6); s < street.path.length_m();) {
    const double step = rng.uniform(5, 10), yaw = side > 0 ? -kPi / 2 : kPi / 2;
    s += step;
    lamp_in -= step;
    if (street.side_street_near(s, side, 1.5)) continue;
    const double kind = rng.uniform();
    if (lamp_in < 0) {
      add_lamp_post(street.mesh, street.frame(s, kerb, true, yaw), rng.uniform(5.5, 8), rng);
      lamp_in = rng.uniform(22, 34);
    } else if (has_trees && kind < 0.55) {
      add_town_tree(street.mesh, street.ground(s, kerb, true), rng.uniform(5, 11), rng);
    } else if (kind < 0.65) {
      add_bin(street.mesh, street.frame(s, wall, true, rng.uniform(0, 0.3)), rng);
    } else if (kind < 0.75) {
      add_traffic_sign(street.mesh, street.frame(s, kerb, true, side > 0 ? kPi : 0.0), rng);
    } else if (kind < 0.82) {
      add_bench(street.mesh, street.frame(s, wall, true, side > 0 ? kPi : 0.0));
    } else if (kind < 0.9) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d foot = street.ground(s + 1.3 * k, side * (street.road_half + 0.3), true);
        add_frustum(street.mesh, foot, foot + Vector3d(0, 0, 0.9), 0.06, 0.05, 8, Material::dark_metal);
      }
    }
  }
}

/// Along the street from one pavement to the other, with a step into every side street.
std::vector<Vector3d> walk(Street& street, const SceneRequest& request, Rng& rng) {
  std::vector<Vector3d> stations;
  const auto stand = [&](double s, double t, bool pavement) {
    stations.push_back(street.ground(s, t, pavement) + Vector3d(0, 0, tripod_height_m(rng)));
  };
  double side = 1;
  for (int k = 0; static_cast<int>(stations.size()) < request.num_stations; ++k) {
    const double s = (k + 0.5) * request.spacing_m + rng.uniform(-0.1, 0.1) * request.spacing_m;
    stand(s, side * (street.road_half + 0.5 * street.pavement), true);
    side = chance(rng, 0.7) ? -side : side;
    for (const SideStreet& x : street.sides) {
      const bool is_here = x.s > s && x.s < s + request.spacing_m * 0.5;
      if (!is_here || static_cast<int>(stations.size()) == request.num_stations) continue;
      const double t = x.side * (street.building_line() + rng.uniform(8, 13));
      stand(x.s + rng.uniform(-1.0, 1.0), t, false);
    }
  }
  return stations;
}

/// How many stations of the walk are on the main street: a side street every third one.
int num_on_axis(int stations) { return std::max(1, (3 * stations + 3) / 4); }

Street plan_street(const SceneRequest& request, Rng& rng) {
  constexpr int kShortestLoop = 12;
  const int on_axis = num_on_axis(request.num_stations);
  const bool is_loop = request.num_stations >= kShortestLoop && on_axis * request.spacing_m > 220;
  const double length = on_axis * request.spacing_m;
  Path path = is_loop ? around_a_block(length, 16, rng) : winding_path(length, 90, rng);
  Street street{std::move(path),
                Terrain(rng.uniform(0.0, 0.035), 0.35, 45, 2, rng),
                rng.uniform(4.6, 6.2),
                rng.uniform(2.4, 3.8),
                is_loop,
                {},
                {}};
  for (int k = 2; k < on_axis; k += 3) {
    SideStreet x;
    x.s = (k - 0.5) * request.spacing_m + rng.uniform(0.15, 0.3) * request.spacing_m;
    x.side = is_loop || chance(rng, 0.5) ? -1.0 : 1.0;
    x.half_width = rng.uniform(3.6, 5.0);
    street.sides.push_back(x);
  }
  return street;
}

}  // namespace

Scene build_street(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "street"));
  Street street = plan_street(request, rng);
  add_street_ground(street);
  for (const double side : {-1.0, 1.0}) {
    add_terrace(street, side, rng);
    add_parked_cars(street, side, rng);
    add_pavement_things(street, side, rng);
  }
  for (const SideStreet& x : street.sides) add_side_street_houses(street, x, rng);
  Scene scene;
  scene.stations = walk(street, request, rng);
  constexpr double kLane_m = 25;
  for (double s = 0; s + kLane_m < street.path.length_m(); s += kLane_m) {
    const double t = 0.25 * street.road_half;
    scene.lanes.push_back({street.ground(s, -t, false), street.ground(s + kLane_m, -t, false)});
    scene.lanes.push_back({street.ground(s + kLane_m, t, false), street.ground(s, t, false)});
  }
  scene.mesh = std::move(street.mesh);
  scene.people_per_scan = 3;
  return scene;
}

}  // namespace isthmus::sim
