#include "simulate/plants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;

Vector3d random_direction(Rng& rng) {
  const double z = rng.uniform(-1, 1), azimuth = rng.uniform(0, 2 * kPi), level = std::sqrt(1 - z * z);
  return {level * std::cos(azimuth), level * std::sin(azimuth), z};
}

/// A tuft of leaves: one triangle of about `size_m` in a random attitude.
void add_tuft(Mesh& mesh, const Vector3d& at, double size_m, Rng& rng) {
  const Vector3d a = size_m * random_direction(rng), b = size_m * random_direction(rng);
  add_triangle(mesh, at, at + a, at + b, Material::leaf);
}

/// Tufts in an ellipsoid, denser towards its skin.
void add_crown(Mesh& mesh, const Vector3d& centre, const Vector3d& half_axes, int tufts, double size_m, Rng& rng) {
  for (int k = 0; k < tufts; ++k) {
    const double radius = std::pow(rng.uniform(), 0.25);
    add_tuft(mesh, centre + radius * random_direction(rng).cwiseProduct(half_axes), size_m * rng.uniform(0.6, 1.4),
             rng);
  }
}

Vector3d sideways(double azimuth, double reach, double rise) {
  return {reach * std::cos(azimuth), reach * std::sin(azimuth), rise};
}

}  // namespace

void add_town_tree(Mesh& mesh, const Vector3d& root, double height_m, Rng& rng) {
  const double trunk = height_m * rng.uniform(0.25, 0.4), radius = height_m * rng.uniform(0.014, 0.022);
  const Vector3d lean = sideways(rng.uniform(0, 2 * kPi), rng.uniform(0, 0.04) * trunk, trunk);
  const Vector3d fork = root + lean;
  add_frustum(mesh, root - Vector3d(0, 0, 0.3), fork, 1.25 * radius, 0.8 * radius, 10, Material::bark);
  const double width = height_m * rng.uniform(0.2, 0.32);
  const int boughs = 4 + static_cast<int>(rng.below(4));
  for (int k = 0; k < boughs; ++k) {
    const double azimuth = 2 * kPi * (k + rng.uniform(0, 0.6)) / boughs;
    const Vector3d tip =
        fork + sideways(azimuth, width * rng.uniform(0.3, 0.8), (height_m - trunk) * rng.uniform(0.3, 0.75));
    add_frustum(mesh, fork - Vector3d(0, 0, rng.uniform(0, 0.15) * trunk), tip, 0.5 * radius, 0.12 * radius, 6,
                Material::bark);
  }
  const Vector3d half(width, width * rng.uniform(0.85, 1.15), 0.42 * (height_m - trunk));
  add_crown(mesh, fork + Vector3d(0, 0, 0.55 * (height_m - trunk)), half, 520, 0.34, rng);
}

void add_forest_tree(Mesh& mesh, const Vector3d& root, double height_m, Rng& rng) {
  const double radius = height_m * rng.uniform(0.007, 0.014);
  const double lean = std::abs(rng.normal()) * 0.04, azimuth = rng.uniform(0, 2 * kPi), bend = rng.uniform(-0.03, 0.03);
  constexpr int kPieces = 5;
  Vector3d from = root - Vector3d(0, 0, 0.3);
  double r0 = 1.35 * radius;  // the flare of the roots
  std::vector<Vector3d> axis{from};
  for (int k = 1; k <= kPieces; ++k) {
    const double share = static_cast<double>(k) / kPieces, out = height_m * (lean * share + bend * share * share);
    const Vector3d to = root + sideways(azimuth, out, share * height_m);
    const double r1 = radius * (1.02 - 0.85 * share);
    add_frustum(mesh, from, to, r0, r1, 10, Material::bark);
    axis.push_back(from = to);
    r0 = r1;
  }
  const int twigs = 8 + static_cast<int>(rng.below(14));
  for (int k = 0; k < twigs; ++k) {
    const double share = rng.uniform(0.12, 0.95) * kPieces;
    const auto piece = static_cast<std::size_t>(share);
    const Vector3d foot = axis[piece] + (share - static_cast<double>(piece)) * (axis[piece + 1] - axis[piece]);
    const double reach = rng.uniform(0.4, 1.6) * (0.5 + 0.2 * share);
    add_frustum(mesh, foot, foot + sideways(rng.uniform(0, 2 * kPi), reach, reach * rng.uniform(-0.2, 0.6)), 0.025,
                0.008, 4, Material::bark);
  }
  const double crown = height_m * rng.uniform(0.25, 0.4);
  add_crown(mesh, axis.back() - Vector3d(0, 0, 0.5 * crown), {1.6, 1.6, 0.6 * crown}, 160, 0.3, rng);
}

void add_bush(Mesh& mesh, const Vector3d& root, double radius_m, Rng& rng) {
  const int stems = 3 + static_cast<int>(rng.below(5));
  for (int k = 0; k < stems; ++k) {
    const Vector3d tip =
        root + sideways(rng.uniform(0, 2 * kPi), radius_m * rng.uniform(0.2, 0.9), radius_m * rng.uniform(0.6, 1.5));
    add_frustum(mesh, root, tip, 0.015, 0.005, 4, Material::bark);
  }
  const Vector3d half(radius_m, radius_m, 0.8 * radius_m);
  add_crown(mesh, root + Vector3d(0, 0, 0.8 * radius_m), half, static_cast<int>(160 + 120 * radius_m), 0.13, rng);
}

void add_stump(Mesh& mesh, const Vector3d& root, Rng& rng) {
  const double radius = rng.uniform(0.12, 0.35);
  add_frustum(mesh, root - Vector3d(0, 0, 0.3), root + Vector3d(0, 0, rng.uniform(0.2, 0.7)), 1.3 * radius, radius, 12,
              Material::bark);
}

void add_log(Mesh& mesh, const Vector3d& from, const Vector3d& to, Rng& rng) {
  const double radius = rng.uniform(0.1, 0.25);
  const Vector3d up(0, 0, 0.7 * radius);
  add_frustum(mesh, from + up, to + up, radius, 0.7 * radius, 10, Material::bark);
}

void add_rock(Mesh& mesh, const Vector3d& at, double size_m, Rng& rng) {
  Transform frame = upright(at, rng.uniform(0, 2 * kPi));
  frame.linear() = frame.linear() * rotation_from_vector({rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), 0});
  add_ellipsoid(mesh, frame, {size_m, size_m * rng.uniform(0.6, 0.9), size_m * rng.uniform(0.35, 0.7)}, 5, 8,
                Material::stone);
}

}  // namespace isthmus::sim
