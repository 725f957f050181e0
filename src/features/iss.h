// Intrinsic shape signatures keypoints.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

/// ISS (Zhong 2009, section 3): points whose scatter within `radius_m` has eigenvalues l1 > l2 > l3 with l2/l1 < gamma
/// and l3/l2 < gamma, and whose smallest eigenvalue (saliency, m2) is the largest within non_max_radius_m. Points are
/// taken to be evenly sampled, so the density weights of the paper are one. Returns one saliency per point, 0 where it
/// is no keypoint. Points with fewer than five neighbours are none.
std::vector<float> iss_saliency(std::span<const Eigen::Vector3f> points, float radius_m, float non_max_radius_m,
                                float gamma);

}  // namespace isthmus
