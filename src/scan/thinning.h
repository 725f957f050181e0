// Noise of a scan, and surfaces that are thinned to the middle of it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "scan/surface.h"

namespace isthmus {

/// Points that stand for `counts` raw points each. `covariances` of these about their means, or empty: zero.
struct CountedPoints {
  std::span<const Eigen::Vector3f> means;
  std::span<const Eigen::Matrix3f> covariances;
  std::span<const std::uint32_t> counts;
};

/// How far points stand off the surfaces they were measured on, in metres: at each of some hundred places the standard
/// deviation along the normal of the smallest neighbourhood that is flat (after Demantké, Mallet, David, Vallet 2011,
/// section 3, who choose the size by entropy), between `smallest_m` and `largest_m` in radius; the middle one counts. 0
/// where hardly a place is flat at any size.
double noise_m(const CountedPoints& points, double smallest_m, double largest_m);

/// Where each of `points` comes to lie on the ridge of the density of `cloud`: shifted along the normal of what
/// surrounds it to the mean of that, some times over (subspace constrained mean shift, Ozertem, Erdogmus 2011, section
/// 3), with a Gaussian kernel of two deviations of the noise.
struct RidgePoint {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;  ///< unit, sign undetermined; zero where too little is near and the point stays
};
std::vector<RidgePoint> thinned(std::span<const Eigen::Vector3f> points, const CountedPoints& cloud, double noise_m);

}  // namespace isthmus
