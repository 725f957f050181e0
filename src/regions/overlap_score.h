// How well a pose explains both scans: surfaces that meet, and surfaces that stand where the other station saw through.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/transform.h"
#include "regions/scan_model.h"

namespace isthmus {

/// A rigid transform in single precision, for scoring.
struct Pose3f {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();
  [[nodiscard]] Eigen::Vector3f operator*(const Eigen::Vector3f& p) const { return rotation * p + translation; }
  [[nodiscard]] Pose3f inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

inline Pose3f pose3f(const Transform& t) { return {t.linear().cast<float>(), t.translation().cast<float>()}; }
inline Transform transform_of(const Pose3f& pose) {
  Transform t = Transform::Identity();
  t.linear() = pose.rotation.cast<double>(), t.translation() = pose.translation.cast<double>();
  return t;
}

/// Shares of the sampled points of one scan against the other.
struct DirectedScore {
  float support = 0;        ///< have a point of the other scan nearby that faces the same way
  float contradiction = 0;  ///< stand where the other station saw through
  float against = 0;        ///< have a point nearby that faces the opposite way
};

enum class PointVerdict : std::uint8_t { neutral, supported, contradicted, against };
using PointVerdicts = std::vector<PointVerdict>;

/// The verdict on each point of `sample` (indices into from's points) under `to_from`. coarse: within about 3 voxels
/// instead of 1.5, and twice the free-space tolerance.
PointVerdicts judge_points(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                           std::span<const std::uint32_t> sample, bool coarse);

/// The shares of these verdicts; nothing if there are none.
DirectedScore shares_of(const PointVerdicts& verdicts);

/// Shares of these verdicts over every `stride`-th of `sample` (indices into from's points; all points if empty).
DirectedScore score_direction(const ScanModel& from, const ScanModel& to, const Pose3f& to_from,
                              std::span<const std::uint32_t> sample, std::size_t stride, bool coarse);

}  // namespace isthmus
