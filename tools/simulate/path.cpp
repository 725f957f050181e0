#include "simulate/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus::sim {
namespace {
constexpr double kStep_m = 0.25;
constexpr double kPi = std::numbers::pi;
}  // namespace

Path::Path(double length_m, double heading_rad, const std::function<double(double)>& curvature) : length_m_(length_m) {
  Vector2d p = Vector2d::Zero();
  double heading = heading_rad;
  const int steps = static_cast<int>(std::ceil(length_m / kStep_m));
  for (int k = 0; k <= steps; ++k) {
    points_.push_back(p);
    headings_.push_back(heading);
    const double turn = kStep_m * curvature((k + 0.5) * kStep_m), middle = heading + turn / 2;
    p += kStep_m * Vector2d(std::cos(middle), std::sin(middle));
    heading += turn;
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
  const double first = rng.uniform(0.6, 1.0) / smallest_radius_m, second = rng.uniform(0.0, 0.35) / smallest_radius_m;
  const double wavelength = rng.uniform(4, 7) * smallest_radius_m, phase = rng.uniform(0, 2 * kPi);
  return Path(length_m, rng.uniform(0, 2 * kPi), [=](double s) {
    return first * std::sin(2 * kPi * s / wavelength + phase) * 0.7 +
           second * std::sin(2 * kPi * s / (0.37 * wavelength));
  });
}

Path around_a_block(double length_m, double corner_radius_m, Rng& rng) {
  const double corner = corner_radius_m * kPi / 2, sides = (length_m - 4 * corner) / 2;
  const double long_side = sides * rng.uniform(0.5, 0.6), short_side = sides - long_side;
  const double start = long_side / 2;  // begin in the middle of a side
  return Path(length_m, rng.uniform(0, 2 * kPi), [=](double s) {
    double along = std::fmod(s + start, length_m);
    for (const double side : {long_side, short_side, long_side, short_side}) {
      if (along < side) return 0.0;
      if (along < side + corner) return 1 / corner_radius_m;
      along -= side + corner;
    }
    return 0.0;
  });
}

}  // namespace isthmus::sim
