// Scans with their poses as PTX (Leica): points in the scan's own frame, the pose in the header.
//
// Per scan: columns, rows; scanner position; three axes; the 4x4 matrix for row vectors, [p 1] * M; then a line a
// point: x y z intensity [r g b]. The grid of the scanner is not known any more: one row, as many columns as points.
#pragma once

#include <filesystem>

#include "base/error.h"
#include "geometry/transform.h"
#include "io/output_file.h"
#include "scan/point_chunk.h"

namespace isthmus::io {

class PtxWriter {
 public:
  static Result<PtxWriter> create(const std::filesystem::path& path);

  /// The scan that add() adds to until the next one.
  Result<void> begin_scan(const Transform& file_from_scan, bool colour);
  /// Points that are not finite are left out. Without intensity PTX's middle, 0.5, is written.
  Result<void> add(const PointChunk& chunk, const Eigen::Vector3d& local_origin_in_scan);
  /// The file appears under its name.
  Result<void> publish();

 private:
  explicit PtxWriter(OutputFile file) : file_(std::move(file)) {}
  Result<void> write(const std::string& text);
  Result<void> finish_scan();

  OutputFile file_;
  std::uint64_t size_ = 0, count_place_ = 0, count_ = 0;
  bool colour_ = false;
  bool in_scan_ = false;
};

}  // namespace isthmus::io
