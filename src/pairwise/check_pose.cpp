#include "pairwise/check_pose.h"

#include <algorithm>

#include "regions/seeds.h"

namespace isthmus {

PoseCheck check_pose(const ScanModel& source, const ScanModel& target, const Transform& target_from_source) {
  constexpr std::size_t kStride = 4;  // of the points
  const Pose3f pose = pose3f(target_from_source);
  const DirectedScore forward = score_direction(source, target, pose, {}, kStride, false);
  const DirectedScore backward = score_direction(target, source, pose.inverse(), {}, kStride, false);
  PoseCheck check;
  check.support = static_cast<double>(std::min(forward.support, backward.support));
  check.contradiction = static_cast<double>(std::max(forward.contradiction, backward.contradiction));
  return check;
}

}  // namespace isthmus
