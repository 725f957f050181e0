// The ground plan of a scan: what stands upright and what lies flat, seen along the vertical.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <unordered_map>
#include <vector>

#include "regions/overlap_score.h"
#include "regions/scan_model.h"

namespace isthmus {

/// The same angle within half a turn of zero.
inline float wrapped(float angle) { return std::remainder(angle, 2 * std::numbers::pi_v<float>); }

/// A cell of the plan in which something stands upright.
struct Column {
  Eigen::Vector2f p;   ///< mean of its points
  float heading = 0;   ///< of the mean normal
  bool faces = false;  ///< has one heading
  float weight = 1;    ///< falls with the number of columns around that face the same way
  float bottom = 0, top = 0;
  template <class F>
  void fields(F&& f) {
    f(p), f(heading), f(faces), f(weight), f(bottom), f(top);
  }
};

/// A point of a horizontal surface.
struct Level {
  Eigen::Vector2f p;
  float z;
  bool up;
  template <class F>
  void fields(F&& f) {
    f(p), f(z), f(up);
  }
};

/// Metres, about the scan's centroid, z along the vertical.
struct GroundPlan {
  std::vector<Column> columns;
  std::vector<Level> levels;
  float radius_m = 0;  ///< of the columns about the origin of the plan
  float cell_m = 0;    ///< one column a cell of this edge
  template <class F>
  void fields(F&& f) {
    f(columns), f(levels), f(radius_m), f(cell_m);
  }
};

struct GroundPlanOptions {
  float cell_voxels = 3;
  int min_height_voxels = 3;      ///< layers that an upright thing fills
  std::size_t max_columns = 700;  ///< the rarest
};

/// Turns a scan's local frame so that `axis` (unit) is z.
Eigen::Matrix3f z_from_axis(const Eigen::Vector3f& axis);

/// The plan of voxel points with their normals and variation, about `middle`. Deterministic, in the order of cells.
struct PlanPoints {
  std::span<const Eigen::Vector3f> points, normals;
  std::span<const float> variation;
  Eigen::Vector3f middle;  ///< of the points: the plan's origin
  float voxel_m = 0;
};
GroundPlan ground_plan(const PlanPoints& scan, const Eigen::Matrix3f& z_from_scan, const GroundPlanOptions& options);

/// That of a model, which remembers it (UprightMemo).
std::shared_ptr<const GroundPlan> ground_plan(const ScanModel& model, const Eigen::Matrix3f& z_from_scan,
                                              const GroundPlanOptions& options);

/// How one plan lies on another: p_target = turn by `yaw` * p_source + shift.
struct PlanPose {
  float yaw = 0;
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  float votes = 0;
};

/// What stands over each cell of the target's plan: heights of floors and ceilings, and where columns begin and end.
class PlanHeights {
 public:
  PlanHeights(const GroundPlan& target, float cell_m);

  /// The one or two shifts along the vertical on which most of the source's heights agree, to a bin.
  [[nodiscard]] std::vector<float> shifts(const GroundPlan& source, const PlanPose& pose, float bin_m) const;

 private:
  static constexpr std::size_t kMaxColumns = 200;  // whose ends are compared
  enum Kind { kUp, kDown, kBottom, kTop };
  [[nodiscard]] std::uint64_t key(const Eigen::Vector2f& p) const;
  float cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<float, int>>> at_;
};

/// target_from_source of the local frames, from a plan's pose about the centroids and a shift along the vertical.
Pose3f pose_of_plan(const ScanModel& source, const ScanModel& target, const Eigen::Matrix3f& z_from_source,
                    const Eigen::Matrix3f& z_from_target, const PlanPose& pose, float height_m);

}  // namespace isthmus
