#include "congruent/synthetic.h"

#include <cmath>
#include <numbers>

namespace isthmus::congruent::test {
namespace {

class Sampler {
 public:
  Sampler(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min, double x_max)
      : spacing_(spacing_m),
        noise_(noise_m),
        normal_noise_(normal_noise_rad),
        x_min_(x_min),
        x_max_(x_max),
        rng_(seed) {}

  // Surface at (u, v) in [0, lu] x [0, lv], both in metres of arc; place(u, v) gives point and normal.
  template <class Place>
  void surface(double lu, double lv, const Place& place) {
    for (double u = 0; u < lu; u += spacing_)
      for (double v = 0; v < lv; v += spacing_) {
        const auto [point, normal] =
            place(std::min(lu, u + rng_.uniform() * spacing_), std::min(lv, v + rng_.uniform() * spacing_));
        keep(point, normal);
      }
  }
  void rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& along_u, const Eigen::Vector3d& along_v) {
    const Eigen::Vector3d u_hat = along_u.normalized(), v_hat = along_v.normalized();
    surface(along_u.norm(), along_v.norm(), [&](double u, double v) {
      return std::pair<Eigen::Vector3d, Eigen::Vector3d>(corner + u * u_hat + v * v_hat, u_hat.cross(v_hat));
    });
  }
  // Four sides and the top of a box that stands at `base`, turned about the vertical.
  void box(const Eigen::Vector3d& base, const Eigen::Vector3d& size, double yaw_rad) {
    const Eigen::Vector3d u = size.x() * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0);
    const Eigen::Vector3d v = size.y() * Eigen::Vector3d(-std::sin(yaw_rad), std::cos(yaw_rad), 0);
    const Eigen::Vector3d w(0, 0, size.z());
    rectangle(base, u, w);
    rectangle(base + u, v, w);
    rectangle(base + u + v, -u, w);
    rectangle(base + v, -v, w);
    rectangle(base + w, u, v);
  }
  void pillar(const Eigen::Vector3d& base, double radius, double height) {
    surface(2 * std::numbers::pi * radius, height, [&](double u, double v) {
      const Eigen::Vector3d n(std::cos(u / radius), std::sin(u / radius), 0);
      return std::pair<Eigen::Vector3d, Eigen::Vector3d>(base + radius * n + Eigen::Vector3d(0, 0, v), n);
    });
  }
  void ball(const Eigen::Vector3d& centre, double radius) {
    surface(2 * std::numbers::pi * radius, 2 * radius, [&](double u, double v) {  // Archimedes: height is area
      const double z = v / radius - 1, ring = std::sqrt(std::max(0.0, 1 - z * z));
      const Eigen::Vector3d n(ring * std::cos(u / radius), ring * std::sin(u / radius), z);
      return std::pair<Eigen::Vector3d, Eigen::Vector3d>(centre + radius * n, n);
    });
  }
  Cloud cloud;

 private:
  void keep(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    const auto noise = [&] { return Eigen::Vector3d(rng_.normal(), rng_.normal(), rng_.normal()); };
    const Eigen::Vector3d p = point + noise_ * noise(), n = (normal + normal_noise_ * noise()).normalized();
    if (point.x() < x_min_ || point.x() > x_max_) return;
    cloud.points.push_back(p.cast<float>());
    cloud.normals.push_back(n.cast<float>());
  }
  double spacing_, noise_, normal_noise_, x_min_, x_max_;
  Rng rng_;
};

}  // namespace

Cloud sample_yard(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min,
                  double x_max) {
  Sampler s(spacing_m, noise_m, normal_noise_rad, seed, x_min, x_max);
  s.rectangle({-3, -2, 0}, {6, 0, 0}, {0, 4, 0});
  s.rectangle({-3, 2, 0}, {6, 0, 0}, {0, 0, 2.5});
  s.rectangle({-3, -2, 0}, {0, 4, 0}, {0, 0, 2.5});
  s.box({-1.8, -0.9, 0}, {0.9, 0.6, 0.8}, 0.4);
  s.box({0.2, 0.6, 0}, {0.7, 0.7, 1.4}, 1.1);
  s.box({1.9, -1.2, 0}, {0.8, 0.5, 0.6}, -0.5);
  s.pillar({0.6, -1.2, 0}, 0.25, 2.0);
  s.ball({2.2, 0.9, 0.6}, 0.5);
  return std::move(s.cloud);
}

Cloud sample_hills(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min,
                   double x_max) {
  Sampler s(spacing_m, noise_m, normal_noise_rad, seed, x_min, x_max);
  s.surface(6, 4, [](double u, double v) {
    const double x = u - 3, y = v - 2;
    const auto height = [](double px, double py) {
      return 0.35 * std::sin(1.7 * px + 0.4 * py * py) + 0.3 * std::sin(2.3 * py - 0.9 * px) +
             0.15 * std::cos(3.1 * px + 2.9 * py + 0.5 * px * px);
    };
    constexpr double kStep = 1e-4;
    const double slope_x = (height(x + kStep, y) - height(x - kStep, y)) / (2 * kStep);
    const double slope_y = (height(x, y + kStep) - height(x, y - kStep)) / (2 * kStep);
    return std::pair<Eigen::Vector3d, Eigen::Vector3d>({x, y, height(x, y)},
                                                       Eigen::Vector3d(-slope_x, -slope_y, 1).normalized());
  });
  return std::move(s.cloud);
}

Cloud sample_balls(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min,
                   double x_max) {
  Sampler s(spacing_m, noise_m, normal_noise_rad, seed, x_min, x_max);
  Rng places(42);  // the same balls for every seed
  for (int i = 0; i < 30; ++i) {
    const double x = places.uniform(-3, 3), y = places.uniform(-2, 2), z = places.uniform(0, 2);
    s.ball({x, y, z}, places.uniform(0.2, 0.6));
  }
  return std::move(s.cloud);
}

Cloud random_cube(std::size_t count, double edge_m, std::uint64_t seed) {
  Rng rng(seed);
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto coordinate = [&] { return static_cast<float>(rng.uniform(-0.5 * edge_m, 0.5 * edge_m)); };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    cloud.points.emplace_back(x, y, z);
    const double a = rng.normal(), b = rng.normal(), c = rng.normal();
    cloud.normals.push_back(Eigen::Vector3d(a, b, c).normalized().cast<float>());
  }
  return cloud;
}

Cloud moved(const Cloud& cloud, const Transform& moved_from_cloud) {
  Cloud out;
  for (const auto& p : cloud.points) out.points.push_back((moved_from_cloud * p.cast<double>()).cast<float>());
  for (const auto& n : cloud.normals)
    out.normals.push_back((moved_from_cloud.linear() * n.cast<double>()).cast<float>());
  return out;
}

Transform random_transform(Rng& rng, double reach_m) {
  const double w = rng.normal(), x = rng.normal(), y = rng.normal(), z = rng.normal();
  Transform t = Transform::Identity();
  t.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) t.translation()[axis] = rng.uniform(-reach_m, reach_m);
  return t;
}

}  // namespace isthmus::congruent::test
