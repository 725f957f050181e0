// Triangles with materials, and the primitives that scenes are made of. Metres, z up, common frame.
//
// Every closed body has its triangles counter-clockwise seen from outside, so that a ray that meets a back face starts
// inside a solid: station placement relies on it. Sheets (glass panes, leaves) have no inside.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/transform.h"

namespace isthmus::sim {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// What a surface is made of; reflectivity_of() gives its brightness at the scanner's wavelength.
enum class Material : std::uint8_t {
  concrete,
  plaster,
  brick,
  stone,
  carpet,
  wood,
  dark_wood,
  metal,
  dark_metal,
  asphalt,
  gravel,
  soil,
  grass,
  bark,
  leaf,
  glass,
  screen,
  rubber,
  paint_white,
  paint_red,
  paint_black,
  cloth_light,
  cloth_dark,
  skin,
  ceramic,
  paper,
};

/// Diffuse reflectivity in the near infrared, 0 to 1 (rounded from published lidar target tables; indicative only).
float reflectivity_of(Material material);
/// Sheets are thin: both faces are outside.
bool is_sheet(Material material);

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Material> materials;  ///< one per triangle
};

/// World-from-object pose that stands upright at `at`, turned by `yaw_rad` about the vertical.
Transform upright(const Vector3d& at, double yaw_rad);

void add_triangle(Mesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, Material material);
/// Corners counter-clockwise seen from outside.
void add_quad(Mesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
              Material material);
/// Axis-aligned in the object's frame, from corner `low` to corner `high`.
void add_box(Mesh& mesh, const Transform& world_from_object, const Vector3d& low, const Vector3d& high,
             Material material);
/// Frustum with caps from `from` (radius r0) to `to` (radius r1), world coordinates; r1 = 0 makes a cone.
void add_frustum(Mesh& mesh, const Vector3d& from, const Vector3d& to, double r0, double r1, int sides,
                 Material material);
/// Ellipsoid of about 2 * rings * sides triangles; half axes in the object's frame.
void add_ellipsoid(Mesh& mesh, const Transform& world_from_object, const Vector3d& half_axes, int rings, int sides,
                   Material material);

/// A hole in a wall: x along the wall, z above its foot.
struct Opening {
  double x0 = 0, x1 = 0, z0 = 0, z1 = 0;
};
/// A wall of boxes around its openings: x from 0 to length, y from 0 to thickness, z from 0 to height in the wall's
/// frame. Openings must not overlap in x; they are sorted here.
void add_wall(Mesh& mesh, const Transform& world_from_wall, double length, double height, double thickness,
              std::vector<Opening> openings, Material material);

}  // namespace isthmus::sim
