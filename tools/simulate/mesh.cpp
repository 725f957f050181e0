#include "simulate/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus::sim {

float reflectivity_of(Material material) {
  switch (material) {
    case Material::concrete:
      return 0.45F;
    case Material::plaster:
      return 0.75F;
    case Material::brick:
      return 0.40F;
    case Material::stone:
      return 0.50F;
    case Material::carpet:
      return 0.30F;
    case Material::wood:
      return 0.60F;
    case Material::dark_wood:
      return 0.25F;
    case Material::metal:
      return 0.55F;
    case Material::dark_metal:
      return 0.12F;
    case Material::asphalt:
      return 0.17F;
    case Material::gravel:
      return 0.35F;
    case Material::soil:
      return 0.28F;
    case Material::grass:
      return 0.45F;
    case Material::bark:
      return 0.35F;
    case Material::leaf:
      return 0.55F;
    case Material::glass:
      return 0.08F;
    case Material::screen:
      return 0.04F;
    case Material::rubber:
      return 0.05F;
    case Material::paint_white:
      return 0.80F;
    case Material::paint_red:
      return 0.45F;
    case Material::paint_black:
      return 0.05F;
    case Material::cloth_light:
      return 0.60F;
    case Material::cloth_dark:
      return 0.15F;
    case Material::skin:
      return 0.55F;
    case Material::ceramic:
      return 0.80F;
    case Material::paper:
      return 0.85F;
  }
  return 0.0F;
}

bool is_sheet(Material material) { return material == Material::glass || material == Material::leaf; }

Transform upright(const Vector3d& at, double yaw_rad) {
  Transform t = Transform::Identity();
  t.linear() = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  t.translation() = at;
  return t;
}

void add_triangle(Mesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, Material material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d* v : {&a, &b, &c}) mesh.vertices.push_back(v->cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.materials.push_back(material);
}

void add_quad(Mesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
              Material material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d* v : {&a, &b, &c, &d}) mesh.vertices.push_back(v->cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

void add_box(Mesh& mesh, const Transform& world_from_object, const Vector3d& low, const Vector3d& high,
             Material material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner((k & 1) ? high.x() : low.x(), (k & 2) ? high.y() : low.y(), (k & 4) ? high.z() : low.z());
    mesh.vertices.push_back((world_from_object * corner).cast<float>());
  }
  static constexpr std::uint32_t kFaces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const auto& f : kFaces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
  mesh.materials.insert(mesh.materials.end(), 12, material);
}

void add_frustum(Mesh& mesh, const Vector3d& from, const Vector3d& to, double r0, double r1, int sides,
                 Material material) {
  const Vector3d axis = (to - from).normalized();
  const Vector3d u = axis.unitOrthogonal();
  const Vector3d v = axis.cross(u);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    const Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
    mesh.vertices.push_back((from + r0 * out).cast<float>());
    mesh.vertices.push_back((to + r1 * out).cast<float>());
  }
  mesh.vertices.push_back(from.cast<float>());
  mesh.vertices.push_back(to.cast<float>());
  const auto n = static_cast<std::uint32_t>(sides);
  const std::uint32_t foot = first + 2 * n, tip = foot + 1;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = first + 2 * k, b = first + 2 * ((k + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({foot, b, a});
    mesh.triangles.push_back({tip, a + 1, b + 1});
  }
  mesh.materials.insert(mesh.materials.end(), 4 * static_cast<std::size_t>(sides), material);
}

void add_ellipsoid(Mesh& mesh, const Transform& world_from_object, const Vector3d& half_axes, int rings, int sides,
                   Material material) {
  const auto at = [&](int ring, int side) -> Vector3d {
    const double polar = std::numbers::pi * ring / rings, azimuth = 2 * std::numbers::pi * (side % sides) / sides;
    const Vector3d unit(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
    return world_from_object * unit.cwiseProduct(half_axes);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int side = 0; side < sides; ++side) {
      const Vector3d a = at(ring, side), b = at(ring + 1, side), c = at(ring + 1, side + 1), d = at(ring, side + 1);
      if (ring + 1 < rings) add_triangle(mesh, a, b, c, material);
      if (ring > 0) add_triangle(mesh, a, c, d, material);
    }
  }
}

void add_wall(Mesh& mesh, const Transform& world_from_wall, double length, double height, double thickness,
              std::vector<Opening> openings, Material material) {
  std::sort(openings.begin(), openings.end(), [](const Opening& a, const Opening& b) { return a.x0 < b.x0; });
  const auto block = [&](double x0, double x1, double z0, double z1) {
    if (x1 > x0 && z1 > z0) add_box(mesh, world_from_wall, {x0, 0, z0}, {x1, thickness, z1}, material);
  };
  double x = 0;
  for (const Opening& hole : openings) {
    block(x, hole.x0, 0, height);
    block(hole.x0, hole.x1, 0, hole.z0);
    block(hole.x0, hole.x1, hole.z1, height);
    x = hole.x1;
  }
  block(x, length, 0, height);
}

}  // namespace isthmus::sim
