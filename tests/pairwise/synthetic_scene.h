// Small scenes of rectangles and a scanner that casts rays at them: scans with a known station and pose, in
// milliseconds.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "base/rng.h"
#include "geometry/transform.h"
#include "scan/point_chunk.h"

namespace isthmus::testing {

using Points = std::vector<Eigen::Vector3f>;

/// corner + a u + b v, a and b in [0, 1]. Opaque from both sides.
struct Rectangle {
  Eigen::Vector3d corner, u, v;
};

struct Scene {
  std::vector<Rectangle> rectangles;  ///< in the world's frame, metres

  void add_rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    rectangles.push_back({corner, u, v});
  }
  /// The six sides of a box.
  void add_box(const Eigen::Vector3d& centre, const Eigen::Vector3d& size,
               const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
    for (int a = 0; a < 3; ++a)
      for (const double side : {-0.5, 0.5}) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        Eigen::Vector3d corner = -0.5 * size, u = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
        corner[a] = side * size[a];
        u[b] = size[b], v[c] = size[c];
        add_rectangle(centre + rotation * corner, rotation * u, rotation * v);
      }
  }
};

inline Transform pose_of(const Eigen::Vector3d& position,
                         const Eigen::Vector3d& rotation_vector = Eigen::Vector3d::Zero()) {
  Transform t = Transform::Identity();
  t.linear() = rotation_from_vector(rotation_vector);
  t.translation() = position;
  return t;
}

/// An empty room: floor, ceiling and four walls around the origin.
inline Scene empty_room(const Eigen::Vector3d& size) {
  Scene scene;
  scene.add_box(Eigen::Vector3d::Zero(), size);
  return scene;
}

/// A hall of about 22 m x 13 m x 4.5 m on z = 0 with boxes of every size at any heading, some tilted, some on the
/// walls, some under the ceiling. The middle, |y| < 1.1, is free for stations. Another seed is another hall of another
/// size: nothing but floors, ceilings and corners is alike.
inline Scene furnished_hall(std::uint64_t seed) {
  Rng rng(seed);
  Scene scene;
  const Eigen::Vector3d size(22 + rng.uniform(-3, 3), 13 + rng.uniform(-2, 2), 4.5 + rng.uniform(-0.7, 0.7));
  scene.add_box({0, 0, size.z() / 2}, size);
  constexpr int kBoxes = 44;
  for (int k = 0; k < kBoxes; ++k) {
    const Eigen::Vector3d box(rng.uniform(0.4, 2.2), rng.uniform(0.4, 1.6), rng.uniform(0.4, 2.8));
    const bool on_wall = k % 4 == 3, tilted = k % 4 == 1, hangs = k % 8 == 2;
    const double side = rng.below(2) ? 1 : -1;
    Eigen::Vector3d centre(rng.uniform(-0.48, 0.48) * size.x(), side * rng.uniform(2.5, 0.45 * size.y()), box.z() / 2);
    if (on_wall) centre.y() = side * 0.5 * size.y(), centre.z() = rng.uniform(1, 3);
    if (hangs) centre.z() = size.z() - 0.2 * box.z();
    const Eigen::Vector3d turn(tilted ? rng.uniform(-0.5, 0.5) : 0, tilted ? rng.uniform(-0.5, 0.5) : 0,
                               on_wall ? 0 : rng.uniform(0, 3));
    scene.add_box(centre, box, rotation_from_vector(turn));
  }
  return scene;
}

/// The scene seen in a mirror (x -> -x): every distance is right and no rigid motion is.
inline Scene mirrored(Scene scene) {
  for (Rectangle& r : scene.rectangles) r.corner.x() = -r.corner.x(), r.u.x() = -r.u.x(), r.v.x() = -r.v.x();
  return scene;
}

/// Range to the first rectangle along the ray (unit direction), if any within max_range_m.
inline std::optional<double> cast_ray(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                      double max_range_m) {
  double nearest = max_range_m;
  bool hit = false;
  for (const Rectangle& r : scene.rectangles) {
    const Eigen::Vector3d n = r.u.cross(r.v);
    const double along = n.dot(direction);
    if (std::abs(along) < 1e-12) continue;
    const double range = n.dot(r.corner - from) / along;
    if (range <= 1e-6 || range >= nearest) continue;
    const Eigen::Vector3d p = from + range * direction - r.corner;
    const double a = p.dot(r.u) / r.u.squaredNorm(), b = p.dot(r.v) / r.v.squaredNorm();
    if (a < 0 || a > 1 || b < 0 || b > 1) continue;
    nearest = range, hit = true;
  }
  return hit ? std::optional<double>(nearest) : std::nullopt;
}

struct ScannerSetup {
  std::size_t num_rays = 60000;  ///< spread evenly over the sphere (Fibonacci)
  double max_range_m = 1e6;
  double noise_m = 0;  ///< standard deviation of the range
  std::uint64_t seed = 1;
};

/// What a scanner with this pose sees, in its own frame: the station is the origin.
inline Points scan_scene(const Scene& scene, const Transform& world_from_scan, const ScannerSetup& setup = {}) {
  Rng rng(setup.seed);
  Points points;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const double start = rng.uniform(0, 6.28);  // no two scans share their beams
  for (std::size_t k = 0; k < setup.num_rays; ++k) {
    const double z = 1 - 2 * (static_cast<double>(k) + 0.5) / static_cast<double>(setup.num_rays),
                 r = std::sqrt(1 - z * z);
    const double angle = golden * static_cast<double>(k) + start;
    const Eigen::Vector3d d(r * std::cos(angle), r * std::sin(angle), z);
    const auto range = cast_ray(scene, world_from_scan.translation(), world_from_scan.linear() * d, setup.max_range_m);
    if (range) points.push_back(((*range + setup.noise_m * rng.normal()) * d).cast<float>());
  }
  return points;
}

/// Even random points on a sphere.
inline Points sphere_points(std::size_t n, const Eigen::Vector3d& centre, double radius_m, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    points.push_back((centre + radius_m * d).cast<float>());
  }
  return points;
}

inline Points moved(const Points& points, const Transform& t) {
  Points out;
  for (const auto& p : points) out.push_back((t * p.cast<double>()).cast<float>());
  return out;
}

inline PointChunk chunk_of(Points points) {
  PointChunk chunk;
  chunk.points = std::move(points);
  return chunk;
}

}  // namespace isthmus::testing
