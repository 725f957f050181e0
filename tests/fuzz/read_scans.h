// What the fuzz targets of the readers share: a file is read in every way that a run reads it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz/bytes_as_file.h"
#include "io/inspect.h"
#include "io/scan_directory.h"

namespace isthmus::fuzz {

/// Ends the program, for the fuzzer to notice, unless `holds`.
inline void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "demanded: %s\n", what);
  std::abort();
}

/// More than any real file holds: a reader must not make points of a header's number alone.
inline constexpr std::uint64_t kMostPointsPerByte = 88;

inline void read_scan(const io::ScanRef& scan, std::uint64_t file_bytes) {
  constexpr std::size_t kChunk = 1000;
  constexpr std::size_t kProbe = 100;
  bool whole = false;
  if (auto reader = io::open_scan(scan)) {
    std::uint64_t num_points = 0;
    for (PointChunk chunk;;) {
      const Result<void> done = (*reader)->read(chunk, kChunk);
      whole = done.has_value();
      if (!whole) {
        demand(!done.error().what.empty(), "an error says what is wrong");
        break;
      }
      if (chunk.points.empty()) break;
      num_points += chunk.points.size();
      demand(chunk.points.size() <= kChunk, "no more points than asked for");
      demand(chunk.intensity.empty() || chunk.intensity.size() == chunk.points.size(), "an intensity for each point");
      demand(chunk.colour.empty() || chunk.colour.size() == chunk.points.size(), "a colour for each point");
      demand(num_points <= file_bytes * kMostPointsPerByte, "no more points than the file can hold");
    }
  }
  const Result<PointChunk> probe = io::probe_scan(scan, kProbe);
  demand(!probe || probe->points.size() <= kProbe, "no more points than a probe asks for");
  demand(io::inspect_scan(scan).has_value() == whole, "looking at a scan succeeds exactly if reading it does");
}

inline int read_scans(const BytesAsFile& file, std::string_view bytes) {
  file.write(bytes);
  const auto scans = io::scans_of_file(file.path());
  if (!scans) return 0;
  for (const io::ScanRef& scan : *scans) read_scan(scan, bytes.size());
  return 0;
}

}  // namespace isthmus::fuzz
