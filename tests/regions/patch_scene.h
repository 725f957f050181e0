// A scan whose surfaces are known point by point: a corner of three square faces, and a bush away from it.
#pragma once

#include <array>
#include <vector>

#include "base/rng.h"
#include "features/feature_cloud.h"
#include "scan/sampled_scan.h"

namespace isthmus::testing {

struct PatchScene {
  static constexpr float kVoxel = 0.1f;
  static constexpr int kSide = 40;  ///< points along a face
  static constexpr int kBush = 3;   ///< faces are 0 (x = 0), 1 (y = 0) and 2 (z = 0)

  SampledScan scan;
  FeatureCloud features;
  std::vector<int> surface;  ///< of each keypoint

  PatchScene() {
    constexpr std::size_t kBushPoints = 400;
    constexpr float kFlat = 0.001f, kRough = 0.2f;
    scan.voxel_m = static_cast<double>(kVoxel);
    for (int face = 0; face < 3; ++face)
      for (int u = 0; u < kSide; ++u)
        for (int v = 0; v < kSide; ++v) {
          Eigen::Vector3f p = Eigen::Vector3f::Zero();
          p[(face + 1) % 3] = (static_cast<float>(u) + 0.5f) * kVoxel;
          p[(face + 2) % 3] = (static_cast<float>(v) + 0.5f) * kVoxel;
          add(p, Eigen::Vector3f::Unit(face), kFlat, u % 2 == 0 && v % 2 == 0 ? face : -1);
        }
    Rng rng(1);
    const auto coordinate = [&](double low) { return static_cast<float>(rng.uniform(low, low + 1)); };
    for (std::size_t i = 0; i < kBushPoints; ++i) {
      const float x = coordinate(8), y = coordinate(8), z = coordinate(0);
      const Eigen::Vector3d n = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
      add({x, y, z}, n.cast<float>(), kRough, i % 4 == 0 ? kBush : -1);
    }
  }

  [[nodiscard]] const Eigen::Vector3f& position(std::size_t keypoint) const {
    return scan.points[features.keypoints[keypoint]];
  }
  /// How far a keypoint of a face is from the nearest other face, and from the one after.
  [[nodiscard]] std::array<float, 2> to_other_faces_m(std::size_t keypoint) const {
    const float a = position(keypoint)[(surface[keypoint] + 1) % 3],
                b = position(keypoint)[(surface[keypoint] + 2) % 3];
    return {std::min(a, b), std::max(a, b)};
  }

 private:
  void add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float variation, int keypoint_surface) {
    if (keypoint_surface >= 0) {
      features.keypoints.push_back(static_cast<std::uint32_t>(scan.points.size()));
      surface.push_back(keypoint_surface);
    }
    scan.points.push_back(p);
    scan.normals.push_back(n);
    scan.variation.push_back(variation);
  }
};

}  // namespace isthmus::testing
