// Feature regions of one scan.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace isthmus {

struct Region {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of its keypoints, local frame
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< mean normal, not normalised: its length tells how flat it is
  float radius_m = 0;                                ///< largest distance of a keypoint from the centre
  std::vector<std::uint32_t> keypoints;              ///< indices into FeatureCloud::keypoints, ascending
  std::vector<std::uint32_t> neighbours;             ///< regions that touch this one, ascending
  template <class F>
  void fields(F&& f) {
    f(centre), f(normal), f(radius_m), f(keypoints), f(neighbours);
  }
};

struct RegionMap {
  std::vector<Region> regions;
  std::vector<std::uint32_t> region_of_keypoint;
  template <class F>
  void fields(F&& f) {
    f(regions), f(region_of_keypoint);
  }
};

}  // namespace isthmus
