#include "report/view_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/rng.h"

namespace isthmus::report {
namespace {

constexpr double kLargest16 = 65535;

/// The first `count` of a random order.
std::vector<std::uint32_t> random_part(std::size_t size, std::size_t count) {
  constexpr std::uint64_t kSeed = 3;
  std::vector<std::uint32_t> order(size);
  std::iota(order.begin(), order.end(), 0U);
  Rng rng(kSeed);
  for (std::size_t k = 0; k < count; ++k) std::swap(order[k], order[k + rng.below(size - k)]);
  order.resize(count);
  return order;
}

void put16(std::string& out, double value) {
  const auto v = static_cast<std::uint32_t>(std::clamp(std::round(value), 0.0, kLargest16));
  out += static_cast<char>(v & 0xffU);
  out += static_cast<char>(v >> 8U);
}

/// Cigolle and others 2014, "A survey of efficient representations for independent unit vectors": octahedral.
std::array<std::int8_t, 2> octahedral(const Eigen::Vector3f& n) {
  const float sum = n.cwiseAbs().sum();
  if (!(sum > 0)) return {0, 0};
  float x = n.x() / sum, y = n.y() / sum;
  if (n.z() < 0) {
    const float folded_x = (1 - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
    y = (1 - std::abs(x)) * (y < 0 ? -1.0f : 1.0f);
    x = folded_x;
  }
  return {static_cast<std::int8_t>(std::lround(127 * x)), static_cast<std::int8_t>(std::lround(127 * y))};
}

/// From the darkest to the brightest hundredth: scanners have no common unit.
void put_intensities(std::string& out, std::span<const float> intensity, std::span<const std::uint32_t> order) {
  std::vector<float> sorted(intensity.begin(), intensity.end());
  std::sort(sorted.begin(), sorted.end());
  const float low = sorted[sorted.size() / 100], high = sorted[sorted.size() - 1 - sorted.size() / 100];
  const float range = high > low ? high - low : 1.0f;
  for (const std::uint32_t i : order)
    out += static_cast<char>(static_cast<std::uint8_t>(255 * std::clamp((intensity[i] - low) / range, 0.0f, 1.0f)));
}

}  // namespace

ViewCloud view_cloud(const SampledScan& scan, std::span<const float> intensity, const Transform& component_from_local,
                     std::size_t max_points) {
  const bool fine = !scan.fine.points.empty();
  const auto& points = fine ? scan.fine.points : scan.points;
  const auto& normals = fine ? scan.fine.normals : scan.normals;
  ViewCloud out;
  out.num_available = points.size();
  out.num_points = std::min(points.size(), max_points);
  out.spacing_m = fine ? scan.fine.voxel_m : scan.voxel_m;
  if (out.num_points == 0) return out;
  const std::vector<std::uint32_t> order = random_part(points.size(), out.num_points);
  std::vector<Eigen::Vector3d> placed;
  placed.reserve(order.size());
  for (const std::uint32_t i : order) placed.push_back(component_from_local * points[i].cast<double>());
  Eigen::Vector3d high = placed.front();
  out.low = placed.front();
  for (const Eigen::Vector3d& p : placed) out.low = out.low.cwiseMin(p), high = high.cwiseMax(p);
  out.step_m = std::max((high - out.low).maxCoeff() / kLargest16, 1e-9);
  out.has_intensity = intensity.size() == points.size();
  out.bytes.reserve(out.num_points * 9);
  for (const Eigen::Vector3d& p : placed)
    for (int k = 0; k < 3; ++k) put16(out.bytes, (p[k] - out.low[k]) / out.step_m);
  const Eigen::Matrix3f rotation = component_from_local.linear().cast<float>();
  for (const std::uint32_t i : order)
    for (const std::int8_t value : octahedral(rotation * normals[i])) out.bytes += static_cast<char>(value);
  if (out.has_intensity) put_intensities(out.bytes, intensity, order);
  return out;
}

}  // namespace isthmus::report
