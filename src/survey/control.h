// What is known about the survey from outside: points and poses in a world frame (a map, a site grid), level scans.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/transform.h"

namespace isthmus {

/// A point that is known in the world and was found in a scan: a target, a ground control point, or the scan's own
/// station.
struct ControlPoint {
  std::string name;
  int scan = 0;
  Eigen::Vector3d p_in_local = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_in_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Zero();  ///< along the world's axes; > 0
};

/// A scan whose pose is known.
struct ControlPose {
  std::string name;
  int scan = 0;
  Transform world_from_local = Transform::Identity();
  double sigma_m = 0;    ///< of the position of the scan's centre; > 0
  double sigma_rad = 0;  ///< > 0
};

/// A scan whose z axis points up.
struct LevelledScan {
  int scan = 0;
  double sigma_rad = 0;  ///< of either tilt; > 0
};

struct Control {
  std::vector<ControlPoint> points;
  std::vector<ControlPose> poses;
  std::vector<LevelledScan> levelled;

  [[nodiscard]] bool empty() const { return points.empty() && poses.empty() && levelled.empty(); }
};

enum class ControlKind : std::uint8_t { point, pose, levelled };

/// What became of one item of control.
struct ControlResult {
  ControlKind kind = ControlKind::point;
  std::string name;  ///< the scan's name for levelled scans
  int scan = 0;
  bool used = false;
  std::string reason;                     ///< why it was not used
  std::optional<Eigen::Vector3d> before;  ///< solved minus known, world axes: with the survey fitted as a rigid whole
  std::optional<Eigen::Vector3d> after;   ///< with the final poses
  std::optional<double> before_rad, after_rad;  ///< of poses and levelled scans
};

/// Where a component stands in the world. World coordinates are large; `shift_m` keeps them out of the computation.
struct Georeference {
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  ///< world = shifted + shift_m
  Transform shifted_from_component = Transform::Identity();
  bool levelled_only = false;  ///< only up is known: heading and place are the anchor's
};

}  // namespace isthmus
