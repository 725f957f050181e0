#include "features/fpfh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

constexpr int kBins = 11;
using Histogram = std::array<float, kFpfhDimension>;

struct PairFeature {
  float theta, alpha, phi;
};

// Darboux frame angles of an oriented pair, as in PCL's computePairFeatures.
std::optional<PairFeature> pair_feature(const Eigen::Vector3f& p1, Eigen::Vector3f n1, const Eigen::Vector3f& p2,
                                        Eigen::Vector3f n2) {
  Eigen::Vector3f d = p2 - p1;
  const float length = d.norm();
  if (!(length > 0)) return std::nullopt;
  const float cosine1 = n1.dot(d) / length, cosine2 = n2.dot(d) / length;
  PairFeature f{};
  if (std::abs(cosine1) < std::abs(cosine2)) {  // the source is the point whose normal lies closer to the line
    std::swap(n1, n2);
    d = -d;
    f.phi = -cosine2;
  } else {
    f.phi = cosine1;
  }
  Eigen::Vector3f v = d.cross(n1);
  const float v_length = v.norm();
  if (!(v_length > 0)) return std::nullopt;
  v /= v_length;
  const Eigen::Vector3f w = n1.cross(v);
  f.alpha = v.dot(n2);
  f.theta = std::atan2(w.dot(n2), n1.dot(n2));
  return f;
}

int bin_of(float unit_value) { return std::clamp(static_cast<int>(std::floor(kBins * unit_value)), 0, kBins - 1); }

Histogram simplified(const PointGrid& grid, std::span<const Eigen::Vector3f> points,
                     std::span<const Eigen::Vector3f> normals, std::size_t i, float radius_m) {
  Histogram h{};
  int n = 0;
  grid.for_each_within(points[i], radius_m, [&](std::uint32_t j, float) {
    if (j == i) return;
    const auto f = pair_feature(points[i], normals[i], points[j], normals[j]);
    if (!f) return;
    ++n;
    h[bin_of((f->theta + std::numbers::pi_v<float>) / (2 * std::numbers::pi_v<float>))] += 1;
    h[kBins + bin_of((f->alpha + 1) * 0.5f)] += 1;
    h[2 * kBins + bin_of((f->phi + 1) * 0.5f)] += 1;
  });
  if (n > 0)
    for (float& value : h) value /= static_cast<float>(n);
  return h;
}

}  // namespace

std::vector<float> fpfh(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                        std::span<const std::uint32_t> carriers, std::span<const std::uint32_t> queries,
                        float radius_m) {
  std::vector<Eigen::Vector3f> carrier_points(carriers.size()), carrier_normals(carriers.size());
  for (std::size_t k = 0; k < carriers.size(); ++k)
    carrier_points[k] = points[carriers[k]], carrier_normals[k] = normals[carriers[k]];
  const PointGrid grid(carrier_points, radius_m);
  std::vector<Histogram> histograms(carriers.size());
  parallel_for_index(carriers.size(), 64, [&](std::size_t i) {
    histograms[i] = simplified(grid, carrier_points, carrier_normals, i, radius_m);
  });
  std::vector<float> rows(queries.size() * kFpfhDimension, 0.0f);
  parallel_for_index(queries.size(), 64, [&](std::size_t q) {
    Histogram sum{};
    grid.for_each_within(points[queries[q]], radius_m, [&](std::uint32_t j, float sq_distance) {
      if (!(sq_distance > 0)) return;
      const float weight = 1.0f / sq_distance;
      for (std::size_t b = 0; b < kFpfhDimension; ++b) sum[b] += weight * histograms[j][b];
    });
    for (int block = 0; block < 3; ++block) {
      float total = 0;
      for (int b = 0; b < kBins; ++b) total += sum[block * kBins + b];
      if (!(total > 0)) continue;
      for (int b = 0; b < kBins; ++b) rows[q * kFpfhDimension + block * kBins + b] = sum[block * kBins + b] / total;
    }
  });
  return rows;
}

}  // namespace isthmus
