// What every export of points does: reads scans chunk by chunk, and never writes over one.
#pragma once

#include <filesystem>
#include <ranges>
#include <system_error>

#include "base/error.h"
#include "io/scan_reader.h"

namespace isthmus::pipelines {

/// Calls take(chunk) for every chunk that is left in the reader, until one fails.
template <class Take>
Result<void> each_chunk(io::ScanReader& reader, const Take& take) {
  constexpr std::size_t kChunkPoints = std::size_t{1} << 16;
  for (PointChunk chunk;;) {
    if (auto read = reader.read(chunk, kChunkPoints); !read) return read;
    if (chunk.points.empty()) return {};
    if (auto taken = take(chunk); !taken) return taken;
  }
}

/// Whether `path` may be written for these scans (of which `file_of` gives the file): there are some, and it is none of
/// them.
template <class Scans, class FileOf>
Result<void> check_export(const std::filesystem::path& path, const Scans& scans, const FileOf& file_of) {
  if (std::ranges::empty(scans)) return fail("there is no scan to export", path.string());
  std::error_code ignored;
  for (const auto& scan : scans) {
    if (std::filesystem::equivalent(file_of(scan), path, ignored))
      return fail("this is a scan of the survey, which would be overwritten", path.string(), "name another place");
  }
  return {};
}

}  // namespace isthmus::pipelines
