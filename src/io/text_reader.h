// Streams points from lines of text: the body of all text formats. A format supplies the parser of one line.
#pragma once

#include <functional>

#include "io/input_file.h"
#include "io/probing_reader.h"

namespace isthmus::io {

struct TextPoint {
  Eigen::Vector3d p_in_scan = Eigen::Vector3d::Zero();
  float intensity = 0.0F;
  std::array<std::uint8_t, 3> colour = {0, 0, 0};
};

enum class LineKind { point, skipped, bad };
using LineParser = std::function<LineKind(std::string_view line, TextPoint& point)>;

/// The part of a file that holds the points.
struct TextBlock {
  std::uint64_t begin_byte = 0;
  std::uint64_t begin_line = 1;
  std::uint64_t end_byte = 0;              ///< where the points end at the latest
  bool only_points = true;                 ///< false: lines of another kind follow the points before end_byte
  std::optional<std::uint64_t> num_lines;  ///< claimed lines with points (no-returns too); fewer are an error
  bool drop_no_returns = false;            ///< points at exactly 0 0 0 are counted and left out
  bool origin_is_station = false;          ///< the format says so; believed unless the points lie over 10 km from there
};

/// Looks at a few points to choose the local origin and returns a reader; fails if there is no point at all.
/// `header` comes with everything but local_origin_in_scan.
OpenedScan open_text(InputFile file, ScanHeader header, LineParser parser, const TextBlock& block);

}  // namespace isthmus::io
