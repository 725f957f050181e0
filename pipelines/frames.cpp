#include "pipelines/frames.h"

namespace isthmus::pipelines {

Transform between_scan_frames(const Transform& target_from_source_local, const Eigen::Vector3d& source_origin,
                              const Eigen::Vector3d& target_origin) {
  Transform out = target_from_source_local;
  out.translation() += target_origin - target_from_source_local.linear() * source_origin;
  return out;
}

}  // namespace isthmus::pipelines
