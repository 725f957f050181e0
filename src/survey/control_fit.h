// A solved component is laid into the world by control: first as a rigid whole, robustly, then with its links.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "survey/control.h"
#include "survey/link_model.h"

namespace isthmus::survey {

/// One item of control, about a node (centred frame), world coordinates with the shift taken off.
struct ControlTerm {
  ControlKind kind = ControlKind::point;
  int node = 0;
  Eigen::Vector3d p_in_node = Eigen::Vector3d::Zero();     ///< point
  Eigen::Vector3d p_in_shifted = Eigen::Vector3d::Zero();  ///< point
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Zero();       ///< point; pose: all alike
  Transform shifted_from_node = Transform::Identity();     ///< pose
  double sigma_rad = 0;                                    ///< pose, levelled
};

/// How far a term is from a pose of its node.
struct ControlMiss {
  Eigen::Vector3d d_m = Eigen::Vector3d::Zero();  ///< solved minus known; zero for levelled scans
  double angle_rad = 0;                           ///< of poses and levelled scans
};
ControlMiss miss_of(const ControlTerm& term, const Transform& shifted_from_node);

/// One connected part of the survey and what is known about it.
struct ControlledPart {
  std::vector<int> nodes;
  int anchor = 0;
  std::span<const Measurement> measurements;  ///< accepted, both ends in the part
  std::vector<ControlTerm> terms;
  std::span<const Transform> root_from_node;   ///< of all nodes of the survey
  std::span<const double> sigma_m, sigma_rad;  ///< likewise: uncertainty of the solved poses relative to the anchor
};

struct ControlFit {
  bool placed = false;
  bool levelled_only = false;
  std::string problem;                                  ///< why it is not placed
  std::vector<std::string> refused;                     ///< per term: why it is not used; empty if it is
  Transform shifted_from_root = Transform::Identity();  ///< the rigid fit
  std::vector<Transform> shifted_from_node;             ///< per entry of `nodes`, links and control together
};

/// Gross errors are found against the rigid fit that most terms agree with, at 99.9 % of their own and the survey's
/// uncertainty (candidates from all poses, triples of points, or pairs of points with level scans; as in Fischler,
/// Bolles 1981, but exhaustive or in a fixed stride: deterministic). Where terms contradict each other and no majority
/// decides, nothing is placed. The rest enters the least squares with the links.
ControlFit fit_control(const ControlledPart& part);

}  // namespace isthmus::survey
