#include "scan/clutter.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_map>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

// Blocks of voxels in eight octants: a surface that crosses a block leaves octants empty, an even spread does not.
using Octants = std::array<std::uint32_t, 8>;

struct Blocks {
  Cell low = Cell::Zero(), size = Cell::Zero();
  std::vector<Octants> octants;  // x fastest
  [[nodiscard]] std::size_t index(const Cell& c) const {
    return static_cast<std::size_t>((c.z() * size.y() + c.y()) * size.x() + c.x());
  }
};

Cell floored(const Eigen::Vector3f& p, double edge) {
  return (p.cast<double>() / edge).array().floor().cast<std::int64_t>();
}

std::int64_t half_of(std::int64_t octant) { return octant >= 0 ? octant / 2 : (octant - 1) / 2; }

// The middle 99 % of each coordinate: a few far points must not make the box endless.
std::array<Eigen::Vector3f, 2> middle_box(std::span<const Eigen::Vector3f> points) {
  std::array<Eigen::Vector3f, 2> box;
  std::vector<float> values(points.size());
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 200;
    box[0][a] = values[cut], box[1][a] = values[values.size() - 1 - cut];
  }
  return box;
}

// Empty if the box is too large to count.
Blocks count_blocks(const OccupiedVoxels& voxels, const std::array<Eigen::Vector3f, 2>& box, std::int64_t half_block) {
  constexpr std::size_t kMostBlocks = 4'000'000;
  const auto& points = voxels.points;
  const double half_edge = static_cast<double>(half_block) * static_cast<double>(voxels.voxel_m);
  const auto block_of = [&](const Eigen::Vector3f& p) -> Cell { return floored(p, half_edge).unaryExpr(&half_of); };
  Blocks blocks;
  blocks.low = block_of(box[0]);
  const Cell high = block_of(box[1]);
  blocks.size = high - blocks.low + Cell::Ones();
  const double volume = blocks.size.cast<double>().prod();
  if (!(volume > 0 && volume <= static_cast<double>(kMostBlocks))) return {};
  blocks.octants.assign(static_cast<std::size_t>(volume), Octants{});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Cell octant = floored(points[i], half_edge);
    const Cell block = octant.unaryExpr(&half_of);
    const Cell at = block - blocks.low;
    if ((at.array() < 0).any() || (at.array() >= blocks.size.array()).any()) continue;
    const Cell part = octant - 2 * block;
    blocks.octants[blocks.index(at)][static_cast<std::size_t>(part.x() + 2 * part.y() + 4 * part.z())] +=
        voxels.counts[i];
  }
  return blocks;
}

std::uint32_t sum(const Octants& o) {
  std::uint32_t total = 0;
  for (const std::uint32_t c : o) total += c;
  return total;
}

// Blocks that have occupied ones on all six sides, near or far: between surfaces, or in the midst of clutter.
std::vector<std::uint8_t> between(const Blocks& blocks) {
  std::vector<std::uint8_t> sides(blocks.octants.size(), 0);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    Cell at;
    for (at[b] = 0; at[b] < blocks.size[b]; ++at[b])
      for (at[c] = 0; at[c] < blocks.size[c]; ++at[c])
        for (const bool upwards : {true, false}) {
          bool met = false;
          for (std::int64_t k = 0; k < blocks.size[a]; ++k) {
            at[a] = upwards ? k : blocks.size[a] - 1 - k;
            const std::size_t i = blocks.index(at);
            sides[i] = static_cast<std::uint8_t>(sides[i] + met);
            met = met || sum(blocks.octants[i]) > 0;
          }
        }
  }
  for (auto& s : sides) s = s == 6;
  return sides;
}

// Chi-squared of the octants against an even share of the block's points; 24.3 is passed by chance once in a thousand.
bool even(const Octants& o) {
  constexpr double kMostChiSquared = 24.3;
  const double mean = sum(o) / 8.0;
  if (mean == 0) return true;
  double chi_squared = 0;
  for (const std::uint32_t c : o) chi_squared += (c - mean) * (c - mean) / mean;
  return chi_squared < kMostChiSquared;
}

// Raw points a block of the air, if they float there evenly; 0 if not. Nothing if the middle block is empty: larger
// ones may tell what little floats there from none.
std::optional<double> points_a_block(const Blocks& blocks) {
  constexpr std::size_t kMinBlocks = 20;
  const std::vector<std::uint8_t> inside = between(blocks);
  std::vector<std::uint32_t> counts;
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (inside[i] && even(blocks.octants[i])) counts.push_back(sum(blocks.octants[i]));
  if (counts.size() < kMinBlocks) return 0;
  std::sort(counts.begin(), counts.end());
  const double median = counts[counts.size() / 2];
  if (median == 0) return std::nullopt;
  // Evenly spread: hardly a block is empty that should not be, and nearly all are as full as the middle one. Scans with
  // a tenth and more of clutter have 95 % alike and more; foliage, far ground and cars of clean ones up to 82 %.
  constexpr double kSpread = 3, kMinAlike = 0.9, kMaxHoles = 0.05;
  std::size_t alike = 0, empty = 0;
  double total = 0;
  for (const std::uint32_t c : counts) {
    empty += c == 0;
    if (std::abs(c - median) > kSpread * std::sqrt(median) + 1) continue;
    ++alike;
    total += c;
  }
  const auto n = static_cast<double>(counts.size());
  if (static_cast<double>(alike) < kMinAlike * n) return 0;
  if (static_cast<double>(empty) > (2 * std::exp(-median) + kMaxHoles) * n) return 0;
  return total / static_cast<double>(alike);
}

}  // namespace

double clutter_density(const OccupiedVoxels& voxels) {
  if (voxels.points.empty()) return 0;
  const auto box = middle_box(voxels.points);
  for (const std::int64_t half_block : {3, 6, 12}) {
    const Blocks blocks = count_blocks(voxels, box, half_block);
    if (blocks.octants.empty()) continue;
    const std::optional<double> points = points_a_block(blocks);
    if (points) return *points / (8.0 * static_cast<double>(half_block * half_block * half_block));
  }
  return 0;
}

std::uint32_t least_count_beyond_chance(double expected) {
  constexpr double kChance = 0.003, kNormalQuantile = 2.75, kNormalFrom = 100;
  if (expected > kNormalFrom)
    return static_cast<std::uint32_t>(std::ceil(expected + kNormalQuantile * std::sqrt(expected) + 1));
  double term = std::exp(-expected), reached = 1;  // P(count >= k)
  std::uint32_t k = 0;
  while (reached >= kChance) {
    reached -= term;
    ++k;
    term *= expected / k;
  }
  return k;
}

std::vector<std::uint8_t> find_clutter(const OccupiedVoxels& voxels, double density) {
  constexpr float kRadiusVoxels = 3.2f, kHalfThicknessVoxels = 0.75f;
  constexpr double kFitted = 1.25;     // a slab laid through what is there catches more than one laid blindly
  constexpr double kThinShare = 0.25;  // of the usual count around
  const auto& points = voxels.points;
  std::vector<std::uint8_t> clutter(points.size(), 0);
  if (!(density > 0)) return clutter;
  const double radius = static_cast<double>(kRadiusVoxels), half = static_cast<double>(kHalfThicknessVoxels);
  const double slab = 2 * half * std::numbers::pi * (radius * radius - half * half / 3);
  const std::uint32_t least_around = least_count_beyond_chance(kFitted * density * slab);
  const std::uint32_t least_inside = std::max(2u, least_count_beyond_chance(density));
  const float radius_m = kRadiusVoxels * voxels.voxel_m, half_m = kHalfThicknessVoxels * voxels.voxel_m;
  const PointGrid grid(points, radius_m);
  parallel_for_index(points.size(), 256, [&](std::size_t i) {
    float others = 0, squares = 0;
    Eigen::Vector3f first = Eigen::Vector3f::Zero();
    Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
    grid.for_each_within(points[i], radius_m, [&](std::uint32_t j, float) {
      if (j == i) return;
      const auto count = static_cast<float>(voxels.counts[j]);
      const Eigen::Vector3f d = points[j] - points[i];
      others += count, squares += count * count;
      first += count * d, second += count * d * d.transpose();
    });
    clutter[i] = 1;
    if (others < static_cast<float>(least_around)) return;
    const auto own = static_cast<float>(voxels.counts[i]);
    const float usual = squares / others;
    if (voxels.counts[i] < least_inside && own < static_cast<float>(kThinShare) * usual) return;
    const Eigen::Vector3f mean = first / others;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(second / others - mean * mean.transpose());
    const Eigen::Vector3f normal = solver.eigenvectors().col(0);
    std::uint32_t beside = 0;
    grid.for_each_within(points[i], radius_m, [&](std::uint32_t j, float) {
      if (j != i && std::abs(normal.dot(points[j] - points[i])) < half_m) beside += voxels.counts[j];
    });
    clutter[i] = beside < least_around;
  });
  return clutter;
}

}  // namespace isthmus
