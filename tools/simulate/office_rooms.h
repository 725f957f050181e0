// Furnishing of one room (or corridor) of an office floor.
#pragma once

#include <vector>

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

struct Rect {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  [[nodiscard]] bool touches(const Rect& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// The clear inside of a room, axis-aligned, floor at z = 0.
struct RoomSpace {
  Rect inside;
  double height_m = 2.8;
  bool is_corridor = false;
  std::vector<Rect> keep_out;  ///< door swings, the scanner's place; furniture adds itself
};

void furnish(Mesh& mesh, RoomSpace& room, Rng& rng);

}  // namespace isthmus::sim
