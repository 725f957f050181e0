// Points about their station: the same numbers wherever on the map a scan stands.
#pragma once

#include <optional>

#include "scan/point_chunk.h"

namespace isthmus {

/// Map coordinates are read against a round origin (io/local_origin.h). Where the station is known it becomes the
/// origin instead, so that the scan is cut into the voxels that it would have in the scanner's own frame: another place
/// of the grid moved poses by 8 mm where the points were thinned to half a voxel. Other scans stay as they are.
class StationFrame {
 public:
  /// Changes the header's local origin.
  explicit StationFrame(ScanHeader& header);
  /// From the reader's local frame. Points at the file's own zero, the mark of no return, become NaN.
  void move(PointChunk& chunk) const;

 private:
  Eigen::Vector3f nothing_;  // the file's zero, in the reader's local frame
  std::optional<Eigen::Vector3d> shift_;
};

}  // namespace isthmus
