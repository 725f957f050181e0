// A winding railway tunnel: lining rings with joints, refuges, cables on brackets, lamps, cabinets, a track. The same
// things over and over, which is what makes tunnels hard.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/path.h"
#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRing_m = 1.5;    ///< length of a lining ring
constexpr double kJoint_m = 0.04;  ///< a groove between rings
constexpr double kEnd_m = 45;      ///< tunnel beyond the first and last station
constexpr double kRefugeWidth_m = 2.0, kRefugeDepth_m = 0.9, kRefugeHeight_m = 2.1;

struct Refuge {
  double s = 0, side = 1;
};

struct Tube {
  Path path;
  double radius, floor_z, grade;  ///< the floor is floor_z below the axis; rise per metre
  std::vector<Refuge> refuges;
  Mesh mesh;
  [[nodiscard]] double half_floor() const { return std::sqrt(radius * radius - floor_z * floor_z); }
  /// z from the floor; t to the left of the axis.
  [[nodiscard]] Vector3d at(double s, double t, double z) const {
    const Vector2d p = path.at(s, t);
    return {p.x(), p.y(), grade * s + z};
  }
  [[nodiscard]] Transform frame(double s, double t, double z) const {
    return upright(at(s, t, z), path.heading_rad(s));
  }
  /// Where the lining is at height z above the floor.
  [[nodiscard]] double half_width(double z) const {
    const double above = z + floor_z_to_axis();
    return std::sqrt(std::max(0.0, radius * radius - above * above));
  }
  [[nodiscard]] double floor_z_to_axis() const { return -floor_z; }
};

/// The lining's profile from the left foot over the crown to the right foot: (t, z) at angle fractions; inward normals
/// follow.
struct Profile {
  std::vector<Vector2d> points;
};
Profile profile_of(const Tube& tube, double offset_m) {
  constexpr int kSides = 40;
  const double foot = std::asin(tube.floor_z / tube.radius);  // below the horizontal
  Profile profile;
  for (int k = 0; k <= kSides; ++k) {
    const double angle = -foot + (kPi + 2 * foot) * k / kSides, r = tube.radius + offset_m;
    profile.points.emplace_back(r * std::cos(angle), r * std::sin(angle) + tube.floor_z);
  }
  return profile;
}

/// The lining from s0 to s1, facing inward, with a hole where `refuge` opens.
void add_lining(Tube& tube, double s0, double s1, const Profile& a, const Profile& b, const Refuge* refuge) {
  for (std::size_t k = 0; k + 1 < a.points.size(); ++k) {
    const Vector2d &p0 = a.points[k], &p1 = a.points[k + 1], &q0 = b.points[k], &q1 = b.points[k + 1];
    const bool is_low = p0.y() < kRefugeHeight_m && p1.y() < kRefugeHeight_m;
    if (refuge != nullptr && is_low && p0.x() * refuge->side > 0) continue;
    add_quad(tube.mesh, tube.at(s0, p0.x(), p0.y()), tube.at(s1, q0.x(), q0.y()), tube.at(s1, q1.x(), q1.y()),
             tube.at(s0, p1.x(), p1.y()), Material::concrete);
  }
}

/// A box cut into the lining, seen from inside: back, sides, top, bottom.
void add_refuge(Tube& tube, double s0, double s1, double side) {
  const double wall = tube.half_floor() - 0.05, back = tube.radius + kRefugeDepth_m, top = kRefugeHeight_m + 0.25;
  const auto p = [&](double s, double t, double z) { return tube.at(s, side * t, z); };
  const auto quad = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    if (side > 0) {
      add_quad(tube.mesh, d, c, b, a, Material::concrete);
    } else {
      add_quad(tube.mesh, a, b, c, d, Material::concrete);
    }
  };
  quad(p(s1, back, 0), p(s0, back, 0), p(s0, back, top), p(s1, back, top));
  quad(p(s0, back, 0), p(s0, wall, 0), p(s0, wall, top), p(s0, back, top));
  quad(p(s1, wall, 0), p(s1, back, 0), p(s1, back, top), p(s1, wall, top));
  quad(p(s0, wall, top), p(s1, wall, top), p(s1, back, top), p(s0, back, top));
  quad(p(s1, wall, 0), p(s0, wall, 0), p(s0, back, 0), p(s1, back, 0));
}

void add_rings(Tube& tube, Rng& rng) {
  constexpr double kOffset_m = 0.008, kGroove_m = 0.03;
  for (double s = -kEnd_m; s < tube.path.length_m() + kEnd_m; s += kRing_m) {
    const Profile ring = profile_of(tube, kOffset_m * rng.uniform(-1, 1)), groove = profile_of(tube, kGroove_m);
    const double s1 = s + kRing_m - kJoint_m;
    const auto refuge =
        std::ranges::find_if(tube.refuges, [&](const Refuge& r) { return r.s >= s && r.s < s + kRing_m + 1e-9; });
    const Refuge* hole = refuge == tube.refuges.end() ? nullptr : &*refuge;
    add_lining(tube, s, s1, ring, ring, hole);
    if (hole != nullptr) add_refuge(tube, s, s1, hole->side);
    add_lining(tube, s1, s1, ring, groove, nullptr);
    add_lining(tube, s1, s + kRing_m, groove, groove, nullptr);
    add_lining(tube, s + kRing_m, s + kRing_m, groove, ring, nullptr);
  }
}

void add_floor(Tube& tube) {
  constexpr double kStep_m = 1.0;
  const double half = tube.half_floor() + 0.1, walk = half - 0.9, kerb = 0.25;
  for (double s = -kEnd_m; s < tube.path.length_m() + kEnd_m; s += kStep_m) {
    const auto strip = [&](double t0, double z0, double t1, double z1, Material m) {
      add_quad(tube.mesh, tube.at(s, t0, z0), tube.at(s + kStep_m, t0, z0), tube.at(s + kStep_m, t1, z1),
               tube.at(s, t1, z1), m);
    };
    strip(-half, kerb, -walk, kerb, Material::concrete);  // a walkway on the right
    strip(-walk, kerb, -walk, 0.0, Material::concrete);
    strip(-walk, 0.0, half, 0.0, Material::gravel);
  }
}

void add_track(Tube& tube) {
  constexpr double kSleeper_m = 0.6, kGauge_m = 1.435, kPiece_m = 1.5;
  const double middle = 0.35;
  for (double s = -kEnd_m; s < tube.path.length_m() + kEnd_m; s += kSleeper_m) {
    add_box(tube.mesh, tube.frame(s, middle, 0), {-0.12, -1.2, 0}, {0.12, 1.2, 0.12}, Material::concrete);
  }
  for (double s = -kEnd_m; s < tube.path.length_m() + kEnd_m; s += kPiece_m) {
    for (const double rail : {-kGauge_m / 2, kGauge_m / 2}) {
      add_box(tube.mesh, tube.frame(s + kPiece_m / 2, middle + rail, 0.12), {-kPiece_m / 2, -0.035, 0},
              {kPiece_m / 2, 0.035, 0.15}, Material::metal);
    }
  }
}

/// Cables sagging between brackets along one side.
void add_cables(Tube& tube, double side, Rng& rng) {
  const double pitch = rng.uniform(1.4, 2.4), low = rng.uniform(1.6, 2.0);
  const int cables = 2 + static_cast<int>(rng.below(4));
  for (double s = -kEnd_m; s < tube.path.length_m() + kEnd_m; s += pitch) {
    for (int k = 0; k < cables; ++k) {
      const double z = low + 0.22 * k, t = side * (tube.half_width(z - 0.0) - 0.12), sag = rng.uniform(0.02, 0.1);
      const Vector3d a = tube.at(s, t, z), b = tube.at(s + pitch, t, z), dip = (a + b) / 2 - Vector3d(0, 0, sag);
      add_frustum(tube.mesh, a, dip, 0.025, 0.025, 6, Material::rubber);
      add_frustum(tube.mesh, dip, b, 0.025, 0.025, 6, Material::rubber);
      const double wall = side * tube.half_width(z);
      add_frustum(tube.mesh, tube.at(s, wall, z - 0.03), tube.at(s, t - side * 0.05, z - 0.03), 0.015, 0.015, 4,
                  Material::metal);
    }
  }
}

void add_equipment(Tube& tube, Rng& rng) {
  const double pitch = rng.uniform(7, 10), height = rng.uniform(3.2, 3.8);
  for (double s = -kEnd_m + rng.uniform(0, pitch); s < tube.path.length_m() + kEnd_m; s += pitch) {
    const double t = -(tube.half_width(height) - 0.15);
    if (chance(rng, 0.93))
      add_box(tube.mesh, tube.frame(s, t, height), {-0.6, -0.08, -0.06}, {0.6, 0.08, 0.06}, Material::paint_white);
  }
  for (double s = -kEnd_m + rng.uniform(0, 10); s < tube.path.length_m() + kEnd_m; s += rng.uniform(5, 22)) {
    const double side = chance(rng, 0.5) ? 1.0 : -1.0, kind = rng.uniform(), width = rng.uniform(0.25, 0.7),
                 tall = rng.uniform(0.4, 1.4);
    const double foot = kind < 0.5 ? (side < 0 ? 0.25 : 0.0) : 1.2,
                 t = side * (tube.half_floor() - (kind < 0.5 ? 0.05 : 0.0));
    const Transform f = tube.frame(s, t, foot);
    if (kind < 0.5) {  // a cabinet at the wall
      add_box(tube.mesh, f, {-width, side > 0 ? -0.4 : 0.0, 0}, {width, side > 0 ? 0.0 : 0.4, tall}, Material::metal);
    } else {  // a sign or a box on the wall
      add_box(tube.mesh, f, {-width / 2, side > 0 ? -0.25 : -0.1, 0}, {width / 2, side > 0 ? 0.1 : 0.25, 0.5 * tall},
              chance(rng, 0.5) ? Material::paint_white : Material::dark_metal);
    }
  }
}

/// Both ends closed by a wall (a works train, a portal under construction).
void close_ends(Tube& tube) {
  const double r = tube.radius + 1.5;
  for (const double s : {-kEnd_m + 0.5, tube.path.length_m() + kEnd_m - 2.0}) {
    add_box(tube.mesh, tube.frame(s, 0, 0), {-0.2, -r, -0.5}, {0.2, r, 2 * r}, Material::wood);
  }
}

}  // namespace

Scene build_tunnel(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "tunnel"));
  const double length = std::max(1, request.num_stations) * request.spacing_m;
  const double radius = rng.uniform(2.7, 3.4);
  Tube tube{winding_path(length, 70, rng), radius, rng.uniform(0.45, 0.6) * radius, rng.uniform(-0.03, 0.03), {}, {}};
  double next = rng.uniform(0, 15);
  for (double s = -kEnd_m + next, side = 1; s < length + kEnd_m - 5; s += rng.uniform(18, 27)) {
    tube.refuges.push_back({s, side});
    side = chance(rng, 0.8) ? -side : side;
  }
  add_rings(tube, rng);
  add_floor(tube);
  add_track(tube);
  add_cables(tube, 1, rng);
  if (chance(rng, 0.5)) add_cables(tube, -1, rng);
  add_equipment(tube, rng);
  close_ends(tube);
  Scene scene;
  for (int k = 0; k < request.num_stations; ++k) {
    const double s = (k + 0.5 + rng.uniform(-0.12, 0.12)) * request.spacing_m, t = rng.uniform(-0.8, 1.0);
    scene.stations.push_back(tube.at(s, t, tripod_height_m(rng)));
  }
  scene.mesh = std::move(tube.mesh);
  scene.people_per_scan = 0.7;
  return scene;
}

}  // namespace isthmus::sim
