// Keypoints and descriptors of one scan.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace isthmus {

/// A direction along which a scan is organised: the vertical of a levelled scan, the axes of a building.
struct DominantAxis {
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< unit; sign: most points' normals along it agree
  float weight = 0;          ///< share of points whose normals are parallel or perpendicular to it
  float sigma_rad = 0;       ///< uncertainty of the direction
  float sign_agreement = 0;  ///< 1: all normals along it point the same way (open ground), 0: as many each way (floor
                             ///< and ceiling); 1 also where the station says which end is up
  /// False: either end of the axis may be up.
  [[nodiscard]] bool knows_its_end() const { return sign_agreement >= 0.9f; }
  bool upright = false;  ///< the instrument's vertical, by what its station could not see (features/upright.h)
  template <class F>
  void fields(F&& f) {
    f(direction), f(weight), f(sigma_rad), f(sign_agreement), f(upright);
  }
};

struct FeatureCloud {
  std::vector<std::uint32_t> keypoints;  ///< indices into SampledScan::points, ascending
  std::vector<float> saliency;           ///< per keypoint; 0 for those added by the top-up
  std::uint32_t dimension = 0;           ///< floats per descriptor
  std::vector<float> descriptors;        ///< keypoints.size() x dimension, a row per keypoint, each row of unit length
  std::vector<DominantAxis> axes;        ///< most likely vertical first; empty when the scan shows none
  template <class F>
  void fields(F&& f) {
    f(keypoints), f(saliency), f(dimension), f(descriptors), f(axes);
  }
};

}  // namespace isthmus
