// Stems of a scan: slender upright things (trunks, posts, columns), as axes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scan/sampled_scan.h"

namespace isthmus {

/// The axis of a slender upright thing. Frame: the one find_stems() was given, z along the vertical; metres.
struct Stem {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();  ///< of the axis, at the height `middle`
  Eigen::Vector2f lean = Eigen::Vector2f::Zero();    ///< metres sideways per metre up
  float radius_m = 0;
  float bottom = 0, middle = 0, top = 0;  ///< heights of the part that stands free
  int layers = 0;                         ///< voxel layers in which it stands free
};

/// Finds what stands alone in at least `min_layers` layers of one voxel, no wider than three voxels there: in each
/// layer the connected cells of upright surface, chained upwards. A scan sees one side of a trunk, and another scan
/// another: the axis is fitted with a circle, whose normals point away from it, so that both find the same.
/// `z_from_scan` turns the local frame so that z is up. Uses the finer sampling where there is one. Deterministic;
/// sorted by place.
std::vector<Stem> find_stems(const SampledScan& scan, const Eigen::Matrix3f& z_from_scan, int min_layers);

}  // namespace isthmus
