// Buildings seen from outside: facades of repeated windows on rectilinear footprints.
#pragma once

#include <vector>

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

/// What all facades of one building share.
struct FacadeStyle {
  Material wall = Material::plaster;
  double floor_height_m = 3.1;
  double bay_m = 2.4;      ///< distance from window to window
  double window_m = 1.2;   ///< width of a window
  double sill_m = 0.9;     ///< its foot above the floor
  double head_m = 2.5;     ///< its top above the floor
  double recess_m = 0.18;  ///< depth of the panes behind the wall
  double balconies = 0.0;  ///< share of the windows above ground
  double blinds = 0.2;     ///< share of the windows
  bool shops = false;      ///< wide panes on the ground floor
  double plinth_m = 0.5;
};
FacadeStyle random_style(Rng& rng);

/// One wall: x along it, y inward, z up from the ground floor; goes down to -foot_m.
void add_facade(Mesh& mesh, const Transform& world_from_facade, double length_m, int floors, double foot_m,
                const FacadeStyle& style, bool has_door, Rng& rng);

/// A rectangle [x0, x1] x [y0, y1] of a footprint.
struct Wing {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};
/// A building on a counter-clockwise outline (building frame) that the wings cover; every side is a facade, doors on
/// the first and a few more. `gable`: a pitched roof on each wing instead of a flat one.
void add_building(Mesh& mesh, const Transform& world_from_building, const std::vector<Vector2d>& outline,
                  const std::vector<Wing>& wings, int floors, double foot_m, const FacadeStyle& style, bool gable,
                  Rng& rng);

}  // namespace isthmus::sim
