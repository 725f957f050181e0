#include "scan/station_frame.h"

#include <limits>

namespace isthmus {

StationFrame::StationFrame(ScanHeader& header) : nothing_((-header.local_origin_in_scan).cast<float>()) {
  if (!header.station_in_scan || header.local_origin_in_scan.isZero()) return;
  shift_ = header.local_origin_in_scan - *header.station_in_scan;
  header.local_origin_in_scan = *header.station_in_scan;
}

void StationFrame::move(PointChunk& chunk) const {
  if (!shift_) return;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (Eigen::Vector3f& p : chunk.points) {
    if (p == nothing_)
      p.setConstant(kNaN);
    else
      p = (p.cast<double>() + *shift_).cast<float>();
  }
}

}  // namespace isthmus
