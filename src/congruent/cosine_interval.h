// "The angle is theta, give or take t" as a comparison of cosines, so that inner loops need no acos.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus::congruent {

struct CosineInterval {
  float low = -2;  ///< below any cosine: the default interval accepts everything
  float high = 2;
  [[nodiscard]] bool contains(float cosine) const { return cosine >= low && cosine <= high; }
};

/// Cosines of the angles within `tolerance_rad` of the angle whose cosine is given. An end that reaches 0 or pi is left
/// open, so that rounding above 1 or below -1 is no reason to refuse.
inline CosineInterval cosines_near(double cosine, double tolerance_rad) {
  const double angle = std::acos(std::min(1.0, std::max(-1.0, cosine)));
  CosineInterval interval;
  if (angle + tolerance_rad < std::numbers::pi) interval.low = static_cast<float>(std::cos(angle + tolerance_rad));
  if (angle - tolerance_rad > 0) interval.high = static_cast<float>(std::cos(angle - tolerance_rad));
  return interval;
}

}  // namespace isthmus::congruent
