// A line through the plane, measured by its length: the axis of a street or a tunnel.
#pragma once

#include <functional>
#include <vector>

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

class Path {
 public:
  /// From the origin, in direction heading_rad(s) at every s from 0 to length_m.
  Path(double length_m, const std::function<double(double s_m)>& heading_rad);
  /// Where the path is at s (extended straight beyond its ends), moved t to the left.
  [[nodiscard]] Vector2d at(double s_m, double t_m = 0) const;
  [[nodiscard]] double heading_rad(double s_m) const;
  [[nodiscard]] double length_m() const { return length_m_; }

 private:
  double length_m_;
  std::vector<Vector2d> points_;  ///< one every kStep_m
  std::vector<double> headings_;
};

/// A gentle S of random bends.
Path winding_path(double length_m, double smallest_radius_m, Rng& rng);
/// Once around a block with rounded corners, back to where it began.
Path around_a_block(double length_m, double corner_radius_m, Rng& rng);

}  // namespace isthmus::sim
