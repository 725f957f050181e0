#include "scan/surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <queue>
#include <tuple>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

constexpr float kRadiiVoxels[] = {2.2f, 3.2f, 4.5f};
constexpr std::size_t kMinNeighbours = 6;
constexpr float kLineRatio = 0.04f;  // middle over largest eigenvalue: below it the neighbours lie on a line

struct Local {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float variation = 1;
  std::uint32_t neighbours = 0;
  bool good = false;
};

Local fit(std::span<const VoxelMoments> voxels, const PointGrid& grid, std::size_t i, float radius_m) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
  Local out;
  const Eigen::Vector3f centre = voxels[i].mean;
  grid.for_each_within(centre, radius_m, [&](std::uint32_t j, float) {
    const Eigen::Vector3f d = voxels[j].mean - centre;
    sum += d;
    second += d * d.transpose() + voxels[j].covariance;
    ++out.neighbours;
  });
  const float n = static_cast<float>(out.neighbours);
  const Eigen::Matrix3f covariance = second / n - (sum / n) * (sum / n).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f values = solver.eigenvalues().cwiseMax(0.0f);
  if (out.neighbours < 3 || !(values.sum() > 0)) return out;
  out.normal = solver.eigenvectors().col(0).normalized();
  out.variation = values[0] / values.sum();
  out.good = out.neighbours >= kMinNeighbours && values[1] > kLineRatio * values[2];
  return out;
}

}  // namespace

SurfaceEstimate estimate_surface(std::span<const VoxelMoments> voxels, float voxel_m) {
  std::vector<Eigen::Vector3f> means(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) means[i] = voxels[i].mean;
  const PointGrid grid(means, 2.2f * voxel_m);
  SurfaceEstimate out;
  out.normals.resize(voxels.size());
  out.variation.assign(voxels.size(), 1.0f);
  out.neighbours.assign(voxels.size(), 0);
  parallel_for_index(voxels.size(), 256, [&](std::size_t i) {
    Local local;
    for (const float radius : kRadiiVoxels) {
      const std::uint32_t first_count = out.neighbours[i];
      local = fit(voxels, grid, i, radius * voxel_m);
      out.neighbours[i] = first_count ? first_count : local.neighbours;
      if (local.good) break;
    }
    out.normals[i] = local.normal.allFinite() ? local.normal : Eigen::Vector3f::UnitZ();
    out.variation[i] = local.good ? local.variation : 1.0f;
  });
  return out;
}

void orient_to_station(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& station,
                       std::span<Eigen::Vector3f> normals) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (normals[i].dot(station - points[i]) < 0) normals[i] = -normals[i];
}

namespace {

// Turns the normals of each connected part alike (Hoppe et al. 1992, section 3.3) and returns the parts.
std::vector<std::vector<std::uint32_t>> orient_parts(std::span<const Eigen::Vector3f> points, float voxel_m,
                                                     std::span<Eigen::Vector3f> normals) {
  const PointGrid grid(points, 2.0f * voxel_m);
  std::vector<char> visited(points.size(), 0);
  std::vector<std::vector<std::uint32_t>> parts;
  using Edge = std::tuple<float, std::uint32_t, std::uint32_t>;  // cost, to, from: ties by index
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> queue;
  for (std::uint32_t seed = 0; seed < points.size(); ++seed) {
    if (visited[seed]) continue;
    std::vector<std::uint32_t>& part = parts.emplace_back();
    queue.emplace(0.0f, seed, seed);
    while (!queue.empty()) {
      const auto [cost, to, from] = queue.top();
      queue.pop();
      if (visited[to]) continue;
      visited[to] = 1;
      part.push_back(to);
      if (normals[to].dot(normals[from]) < 0) normals[to] = -normals[to];
      grid.for_each_within(points[to], 2.0f * voxel_m, [&, at = to](std::uint32_t j, float) {
        if (!visited[j]) queue.emplace(1.0f - std::abs(normals[at].dot(normals[j])), j, at);
      });
    }
  }
  return parts;
}

void flip(std::span<const std::uint32_t> part, std::span<Eigen::Vector3f> normals) {
  for (const auto i : part) normals[i] = -normals[i];
}

// The direction to look from that sees one side of every part, if there is one: a depth image has it, a body scanned
// all round has not.
std::optional<Eigen::Vector3f> single_view(const std::vector<std::vector<std::uint32_t>>& parts,
                                           std::span<const Eigen::Vector3f> normals) {
  constexpr int kDirections = 400;     // on a half sphere: about 7 degrees apart
  constexpr float kMinCosine = 0.15f;  // seen flatter, a noisy normal has no side
  constexpr double kMinConsistent = 0.95;
  constexpr std::size_t kMaxNormals = 6000;
  const std::size_t stride = std::max<std::size_t>(1, normals.size() / kMaxNormals);
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  double best = 0, best_consistent = 0;
  Eigen::Vector3f view = Eigen::Vector3f::UnitZ();
  for (int k = 0; k < kDirections; ++k) {
    const double z = (k + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const Eigen::Vector3f v(static_cast<float>(r * std::cos(golden * k)), static_cast<float>(r * std::sin(golden * k)),
                            static_cast<float>(z));
    double facing = 0, consistent = 0, counted = 0;
    for (const auto& part : parts) {
      double sum = 0;
      std::size_t towards = 0, away = 0;
      for (std::size_t i = 0; i < part.size(); i += stride) {
        const float c = normals[part[i]].dot(v);
        sum += static_cast<double>(c);
        towards += c > kMinCosine;
        away += c < -kMinCosine;
      }
      facing += std::abs(sum);
      consistent += static_cast<double>(std::max(towards, away));
      counted += static_cast<double>(towards + away);
    }
    if (facing > best) best = facing, best_consistent = consistent / std::max(counted, 1.0), view = v;
  }
  return best_consistent > kMinConsistent ? std::optional(view) : std::nullopt;
}

}  // namespace

void orient_outwards(std::span<const Eigen::Vector3f> points, float voxel_m, std::span<Eigen::Vector3f> normals) {
  const auto parts = orient_parts(points, voxel_m, normals);
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const auto& p : points) centroid += p.cast<double>();
  centroid /= static_cast<double>(std::max<std::size_t>(points.size(), 1));
  const auto outwards = [&](std::span<const std::uint32_t> part) {
    double sum = 0;
    for (const auto i : part) sum += normals[i].cast<double>().dot(points[i].cast<double>() - centroid);
    return sum;
  };
  const auto view = single_view(parts, normals);
  if (!view) {
    for (const auto& part : parts)
      if (outwards(part) < 0) flip(part, normals);
    return;
  }
  // Every point stands for the area it covers in the image. About the middle of that area, the sum over a depth image
  // is twice the volume between each surface and its rim: what is seen bulges towards the viewer.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& part : parts) {
    double facing = 0;
    for (const auto i : part) facing += static_cast<double>(normals[i].dot(*view));
    if (facing < 0) flip(part, normals);
    for (const auto i : part) {
      const double covered = std::max(0.0, static_cast<double>(normals[i].dot(*view)));
      middle += covered * points[i].cast<double>(), area += covered;
    }
  }
  centroid = middle / std::max(area, 1e-12);
  double sum = 0;
  for (const auto& part : parts) sum += outwards(part);
  if (sum < 0)
    for (const auto& part : parts) flip(part, normals);
}

void orient_like(std::span<const Eigen::Vector3f> coarse_points, std::span<const Eigen::Vector3f> coarse_normals,
                 float voxel_m, std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> normals) {
  const PointGrid grid(coarse_points, 2 * voxel_m);
  parallel_for_index(points.size(), 256, [&](std::size_t i) {
    float vote = 0;
    grid.for_each_within(points[i], 2 * voxel_m, [&](std::uint32_t j, float sq_distance) {
      vote += coarse_normals[j].dot(normals[i]) / (sq_distance + 0.01f * voxel_m * voxel_m);
    });
    if (vote < 0) normals[i] = -normals[i];
  });
}

}  // namespace isthmus
