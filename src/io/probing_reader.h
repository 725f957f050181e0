// What every reader of ours can do beyond the public contract: look at a few points without reading all of them.
#pragma once

#include "io/scan_reader.h"

namespace isthmus::io {

class ProbingReader : public ScanReader {
 public:
  /// About `max_points` points spread evenly over the scan, in reading order; see io::probe_scan. Independent of, and
  /// without effect on, what read() returns next unless said otherwise.
  virtual Result<PointChunk> probe(std::size_t max_points) = 0;
};

using OpenedScan = Result<std::unique_ptr<ProbingReader>>;

/// Probing places: up to this many windows of this many bytes are looked at, so that a probe of any file costs at most
/// 32 MiB of reading.
inline constexpr std::size_t kProbeWindows = 2048;
inline constexpr std::size_t kProbeWindowBytes = std::size_t{1} << 14;

/// Points looked at when a scan is opened, to choose its local origin and to recognise its value ranges.
inline constexpr std::size_t kOpeningSample = 512;

/// A chunk never reserves more than this ahead, whatever a caller or a header asks for.
inline constexpr std::size_t kReserveAtMost = std::size_t{1} << 16;

}  // namespace isthmus::io
