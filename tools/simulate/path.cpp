#include "simulate/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus::sim {
namespace {
constexpr double kStep_m = 0.25;
constexpr double kPi = std::numbers::pi;
}  // namespace

Path::Path(double length_m, const std::function<double(double)>& heading_rad) : length_m_(length_m) {
  Vector2d p = Vector2d::Zero();
  const int steps = static_cast<int>(std::ceil(length_m / kStep_m));
  for (int k = 0; k <= steps; ++k) {
    points_.push_back(p);
    headings_.push_back(heading_rad(k * kStep_m));
    const double middle = heading_rad((k + 0.5) * kStep_m);
    p += kStep_m * Vector2d(std::cos(middle), std::sin(middle));
  }
}

double Path::heading_rad(double s_m) const {
  const double at = std::clamp(s_m / kStep_m, 0.0, static_cast<double>(headings_.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(at), headings_.size() - 2);
  return headings_[k] + (at - static_cast<double>(k)) * (headings_[k + 1] - headings_[k]);
}

Vector2d Path::at(double s_m, double t_m) const {
  const double inside = std::clamp(s_m / kStep_m, 0.0, static_cast<double>(points_.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(inside), points_.size() - 2);
  const double heading = heading_rad(s_m);
  const Vector2d along(std::cos(heading), std::sin(heading)), left(-along.y(), along.x());
  const Vector2d on_path = points_[k] + (inside - static_cast<double>(k)) * (points_[k + 1] - points_[k]);
  return on_path + (s_m - inside * kStep_m) * along + t_m * left;
}

Path winding_path(double length_m, double smallest_radius_m, Rng& rng) {
  // Two waves of heading; the steepest sum of their slopes is the sharpest bend.
  const double wavelength = rng.uniform(4, 7) * smallest_radius_m, phase = rng.uniform(0, 2 * kPi);
  const double long_share = rng.uniform(0.5, 0.7), short_share = rng.uniform(0.0, 0.3), ratio = 0.37;
  const double reach = wavelength / (2 * kPi * smallest_radius_m), start = rng.uniform(0, 2 * kPi);
  return Path(length_m, [=](double s) {
    const double turn = 2 * kPi * s / wavelength;
    return start + reach * (long_share * std::sin(turn + phase) + ratio * short_share * std::sin(turn / ratio));
  });
}

Path around_a_block(double length_m, double corner_radius_m, Rng& rng) {
  const double corner = corner_radius_m * kPi / 2, sides = (length_m - 4 * corner) / 2;
  const double long_side = sides * rng.uniform(0.5, 0.6), short_side = sides - long_side;
  const double begin = long_side / 2, start = rng.uniform(0, 2 * kPi);  // begin in the middle of a side
  return Path(length_m, [=](double s) {
    double along = s + begin, heading = start;
    for (const double side : {long_side, short_side, long_side, short_side, long_side}) {
      if (along < side) return heading;
      if (along < side + corner) return heading + (along - side) / corner_radius_m;
      along -= side + corner;
      heading += kPi / 2;
    }
    return heading;
  });
}

}  // namespace isthmus::sim
