#include "pipelines/frames.h"

namespace isthmus::pipelines {

Transform between_scan_frames(const Transform& target_from_source_local, const Eigen::Vector3d& source_origin,
                              const Eigen::Vector3d& target_origin) {
  Transform out = target_from_source_local;
  out.translation() += target_origin - target_from_source_local.linear() * source_origin;
  return out;
}

Transform between_local_frames(const Transform& target_from_source_scan, const Eigen::Vector3d& source_origin,
                               const Eigen::Vector3d& target_origin) {
  return between_scan_frames(target_from_source_scan, -source_origin, -target_origin);
}

Matrix6d information_in_scan_frame(const Matrix6d& information_local, const Eigen::Vector3d& source_origin) {
  // T_scan = O_t T_local O_s^-1, so d_scan = Ad(O_s) d_local and d_local = Ad(O_s^-1) d_scan; for a pure shift o,
  // Ad(O^-1) = [I, -[o]x; 0, I] on (translation, rotation).
  Matrix6d local_from_scan = Matrix6d::Identity();
  local_from_scan.topRightCorner<3, 3>() << 0, source_origin.z(), -source_origin.y(),  //
      -source_origin.z(), 0, source_origin.x(),                                        //
      source_origin.y(), -source_origin.x(), 0;
  const Matrix6d information = local_from_scan.transpose() * information_local * local_from_scan;
  return 0.5 * (information + information.transpose());
}

}  // namespace isthmus::pipelines
