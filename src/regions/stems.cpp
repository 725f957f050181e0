#include "regions/stems.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>

namespace isthmus {
namespace {

constexpr float kMaxUpright = 0.5f;  // of a normal along the vertical
constexpr int kMaxWidth = 3;         // cells
constexpr int kMaxGap = 3;           // layers that a twig or a bush may hide
constexpr float kMaxStep = 1.0f;     // cells sideways from layer to layer, and per missing layer half of it

struct SurfacePoint {
  Eigen::Vector3f p, n;
};

struct Cell {
  std::int32_t z, y, x;
  std::uint32_t point;
  [[nodiscard]] bool same_place(const Cell& o) const { return z == o.z && y == o.y && x == o.x; }
};

std::uint64_t key_of(std::int32_t z, std::int32_t y, std::int32_t x) {
  constexpr std::int64_t kOffset = 1 << 20;
  return static_cast<std::uint64_t>(z + kOffset) << 42 | static_cast<std::uint64_t>(y + kOffset) << 21 |
         static_cast<std::uint64_t>(x + kOffset);
}

// Points of upright surface in the turned frame.
std::vector<SurfacePoint> upright_points(const SampledScan& scan, const Eigen::Matrix3f& z_from_scan) {
  const bool fine = !scan.fine.points.empty();
  const std::span<const Eigen::Vector3f> points = fine ? scan.fine.points : scan.points,
                                         normals = fine ? scan.fine.normals : scan.normals;
  const std::span<const float> variation = fine ? scan.fine.variation : scan.variation;
  std::vector<SurfacePoint> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (variation[i] >= 1) continue;
    const Eigen::Vector3f n = z_from_scan * normals[i];
    if (std::abs(n.z()) < kMaxUpright) out.push_back({z_from_scan * points[i], n});
  }
  return out;
}

struct Blob {  // connected cells of one layer, small enough to be a stem
  std::int32_t layer = 0;
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  std::vector<std::uint32_t> points;
};

// Blobs of all layers, by layer and then by place.
std::vector<Blob> slender_blobs(const std::vector<SurfacePoint>& points, float cell_m) {
  std::vector<Cell> cells(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f g = points[i].p / cell_m;
    cells[i] = {static_cast<std::int32_t>(std::floor(g.z())), static_cast<std::int32_t>(std::floor(g.y())),
                static_cast<std::int32_t>(std::floor(g.x())), i};
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
    if (a.z != b.z) return a.z < b.z;
    if (a.y != b.y) return a.y < b.y;
    return a.x != b.x ? a.x < b.x : a.point < b.point;
  });
  std::vector<std::uint32_t> first;  // of each place
  std::unordered_map<std::uint64_t, std::uint32_t> place_of;
  for (std::uint32_t k = 0; k < cells.size(); ++k)
    if (k == 0 || !cells[k].same_place(cells[k - 1])) {
      place_of.emplace(key_of(cells[k].z, cells[k].y, cells[k].x), static_cast<std::uint32_t>(first.size()));
      first.push_back(k);
    }
  std::vector<Blob> blobs;
  std::vector<bool> done(first.size(), false);
  std::vector<std::uint32_t> front;
  for (std::uint32_t start = 0; start < first.size(); ++start) {
    if (done[start]) continue;
    done[start] = true;
    front.assign(1, start);
    std::int32_t low_x = cells[first[start]].x, high_x = low_x, low_y = cells[first[start]].y, high_y = low_y;
    for (std::size_t at = 0; at < front.size(); ++at) {
      const Cell& c = cells[first[front[at]]];
      low_x = std::min(low_x, c.x), high_x = std::max(high_x, c.x);
      low_y = std::min(low_y, c.y), high_y = std::max(high_y, c.y);
      for (std::int32_t dy = -1; dy <= 1; ++dy)
        for (std::int32_t dx = -1; dx <= 1; ++dx) {
          const auto found = place_of.find(key_of(c.z, c.y + dy, c.x + dx));
          if (found == place_of.end() || done[found->second]) continue;
          done[found->second] = true;
          front.push_back(found->second);
        }
    }
    if (high_x - low_x >= kMaxWidth || high_y - low_y >= kMaxWidth) continue;
    Blob blob;
    blob.layer = cells[first[start]].z;
    for (const std::uint32_t place : front) {
      const std::uint32_t end = place + 1 < first.size() ? first[place + 1] : static_cast<std::uint32_t>(cells.size());
      for (std::uint32_t k = first[place]; k < end; ++k) {
        blob.points.push_back(cells[k].point);
        blob.mean += points[cells[k].point].p.head<2>();
      }
    }
    blob.mean /= static_cast<float>(blob.points.size());
    blobs.push_back(std::move(blob));
  }
  return blobs;
}

// p = centre + lean (z - middle) + radius n, in least squares; a radius that the normals do not tell stays near half a
// voxel, a lean that the height does not tell near none.
std::optional<Stem> fitted(const std::vector<SurfacePoint>& points, const std::vector<std::uint32_t>& inside,
                           float cell_m) {
  constexpr float kNoise = 0.2f, kRadius = 0.5f, kLean = 0.1f;  // standard deviations: cells, cells, 1
  constexpr float kAlike = 10;                                  // neighbouring points err together
  float middle = 0;
  for (const std::uint32_t i : inside) middle += points[i].p.z();
  middle /= static_cast<float>(inside.size());
  Eigen::Matrix<float, 5, 5> a = Eigen::Matrix<float, 5, 5>::Zero();
  Eigen::Matrix<float, 5, 1> b = Eigen::Matrix<float, 5, 1>::Zero();
  const Eigen::Vector2f about = points[inside.front()].p.head<2>();
  for (const std::uint32_t i : inside) {
    const Eigen::Vector2f n = points[i].n.head<2>().normalized();
    const float h = points[i].p.z() - middle;
    Eigen::Matrix<float, 2, 5> row;
    row << 1, 0, h, 0, n.x(), 0, 1, 0, h, n.y();
    a += row.transpose() * row;
    b += row.transpose() * (points[i].p.head<2>() - about);
  }
  const float lean_weight = kAlike * (kNoise * cell_m / kLean) * (kNoise * cell_m / kLean);
  const float radius_weight =
      kAlike * (kNoise / kRadius) * (kNoise / kRadius) + 0.02f * static_cast<float>(inside.size());
  a(2, 2) += lean_weight, a(3, 3) += lean_weight;
  a(4, 4) += radius_weight, b(4) += radius_weight * kRadius * cell_m;
  const Eigen::Matrix<float, 5, 1> x = a.ldlt().solve(b);
  if (!x.allFinite() || x(4) < 0 || x(4) > 2 * cell_m) return std::nullopt;
  Stem stem;
  stem.centre = about + x.head<2>();
  stem.lean = x.segment<2>(2);
  stem.radius_m = x(4);
  stem.middle = middle;
  return stem;
}

}  // namespace

std::vector<Stem> find_stems(const SampledScan& scan, const Eigen::Matrix3f& z_from_scan, int min_layers) {
  const auto cell_m = static_cast<float>(scan.voxel_m);
  const std::vector<SurfacePoint> points = upright_points(scan, z_from_scan);
  const std::vector<Blob> blobs = slender_blobs(points, cell_m);
  struct Chain {
    std::vector<std::uint32_t> points;
    Eigen::Vector2f last;
    std::int32_t first_layer = 0, last_layer = 0;
    int layers = 0;
  };
  std::vector<Chain> chains;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> open;  // chains by the cell of their last blob
  const auto cell_key = [cell_m](const Eigen::Vector2f& p, int dx, int dy) {
    return key_of(0, static_cast<std::int32_t>(std::floor(p.y() / cell_m)) + dy,
                  static_cast<std::int32_t>(std::floor(p.x() / cell_m)) + dx);
  };
  constexpr int kReach = static_cast<int>(kMaxStep + 0.5f * kMaxGap) + 1;
  for (const Blob& blob : blobs) {
    std::uint32_t best = 0;
    float best_distance = std::numeric_limits<float>::infinity();
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const auto found = open.find(cell_key(blob.mean, dx, dy));
        if (found == open.end()) continue;
        for (const std::uint32_t k : found->second) {
          const Chain& chain = chains[k];
          const std::int32_t gap = blob.layer - chain.last_layer;
          if (gap < 1 || gap > kMaxGap) continue;
          const float distance = (blob.mean - chain.last).norm();
          if (distance > cell_m * (kMaxStep + 0.5f * static_cast<float>(gap - 1))) continue;
          if (distance < best_distance || (distance == best_distance && k < best)) best = k, best_distance = distance;
        }
      }
    if (!std::isfinite(best_distance)) {
      best = static_cast<std::uint32_t>(chains.size());
      chains.push_back({{}, blob.mean, blob.layer, blob.layer, 0});
    } else {
      auto& before = open[cell_key(chains[best].last, 0, 0)];
      before.erase(std::find(before.begin(), before.end(), best));
    }
    Chain& chain = chains[best];
    chain.points.insert(chain.points.end(), blob.points.begin(), blob.points.end());
    chain.last = blob.mean, chain.last_layer = blob.layer, ++chain.layers;
    open[cell_key(blob.mean, 0, 0)].push_back(best);
  }
  std::vector<Stem> stems;
  for (const Chain& chain : chains) {
    if (chain.layers < min_layers) continue;
    auto stem = fitted(points, chain.points, cell_m);
    if (!stem) continue;
    stem->bottom = static_cast<float>(chain.first_layer) * cell_m;
    stem->top = static_cast<float>(chain.last_layer + 1) * cell_m;
    stem->layers = chain.layers;
    stems.push_back(*stem);
  }
  std::sort(stems.begin(), stems.end(), [](const Stem& a, const Stem& b) {
    return a.centre.x() != b.centre.x() ? a.centre.x() < b.centre.x() : a.centre.y() < b.centre.y();
  });
  return stems;
}

}  // namespace isthmus
