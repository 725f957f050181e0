#include "pipelines/ptx_export.h"

#include "io/ptx/ptx_writer.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kChunkPoints = std::size_t{1} << 16;

Result<void> append_scan(io::PtxWriter& writer, const PlacedScan& placed) {
  auto reader = io::open_scan(placed.scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  const ScanHeader& header = (*reader)->header();
  if (auto begun = writer.begin_scan(placed.file_from_scan, header.has_colour); !begun) return begun;
  for (PointChunk chunk;;) {
    if (auto read = (*reader)->read(chunk, kChunkPoints); !read) return read;
    if (chunk.points.empty()) return {};
    if (auto added = writer.add(chunk, header.local_origin_in_scan); !added) return added;
  }
}

}  // namespace

Result<void> export_ptx(const std::filesystem::path& path, const std::vector<PlacedScan>& scans) {
  if (scans.empty()) return fail("there is no scan to export", path.string());
  std::error_code ignored;
  for (const PlacedScan& placed : scans) {
    if (!std::filesystem::equivalent(placed.scan.path, path, ignored)) continue;
    return fail("this is a scan of the survey, which would be overwritten", path.string(), "name another place");
  }
  auto writer = io::PtxWriter::create(path);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  for (const PlacedScan& placed : scans) {
    if (auto appended = append_scan(*writer, placed); !appended) return appended;
  }
  return writer->publish();
}

}  // namespace isthmus::pipelines
