// Opening scans: a path becomes one or more scans, a scan becomes chunks of points in its own frame.
//
// Frames. "scan" is the frame of the coordinates as stored in the file (double). "local" is that frame shifted by
// `local_origin_in_scan`, chosen by the reader from the header or the first points so that floats lose nothing (zero
// for formats that already store small coordinates): p_in_scan = p_in_local.cast<double>() + local_origin_in_scan.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"
#include "scan/point_chunk.h"

namespace isthmus::io {

/// Where a scan lies in a file that holds several; end_byte 0 = unknown, it is looked for when the scan is opened.
struct FilePlace {
  std::uint64_t first_byte = 0, end_byte = 0;
  std::uint64_t first_line = 1;
};

/// One scan of one file.
struct ScanRef {
  std::filesystem::path path;
  int index = 0;     ///< which scan of the file, from 0
  std::string name;  ///< path relative to the input folder, "#k" (= index) if the file holds several, percent-encoded
  FilePlace place = {};  ///< filled in by scans_of_file for formats that need it; never needed from a caller
};

using isthmus::PointChunk;
using isthmus::ScanHeader;

/// Streams one scan. Not shared between threads.
class ScanReader {
 public:
  virtual ~ScanReader() = default;
  [[nodiscard]] virtual const ScanHeader& header() const = 0;
  /// Replaces `chunk` by up to `max_points` next points; an empty chunk means the end. An error ends the reading.
  virtual Result<void> read(PointChunk& chunk, std::size_t max_points) = 0;
};

/// The scans of one file (several for E57 and PTX), from headers alone where the format allows.
Result<std::vector<ScanRef>> scans_of_file(const std::filesystem::path& path);

Result<std::unique_ptr<ScanReader>> open_scan(const ScanRef& scan);

/// About `max_points` points spread evenly over the file, without reading all of it where the format allows (fixed-size
/// records: strides; text: blocks at even offsets). Deterministic. For choosing parameters before the real reading.
Result<PointChunk> probe_scan(const ScanRef& scan, std::size_t max_points);

}  // namespace isthmus::io
