#include "pipelines/ptx_export.h"

#include "io/ptx/ptx_writer.h"
#include "pipelines/export_scans.h"

namespace isthmus::pipelines {
namespace {

Result<void> append_scan(io::PtxWriter& writer, const PlacedScan& placed) {
  auto reader = io::open_scan(placed.scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  const ScanHeader& header = (*reader)->header();
  if (auto begun = writer.begin_scan(placed.file_from_scan, header.has_colour); !begun) return begun;
  return each_chunk(**reader, [&](const PointChunk& chunk) { return writer.add(chunk, header.local_origin_in_scan); });
}

}  // namespace

Result<void> export_ptx(const std::filesystem::path& path, const std::vector<PlacedScan>& scans) {
  const auto file_of = [](const PlacedScan& placed) { return placed.scan.path; };
  if (auto good = check_export(path, scans, file_of); !good) return good;
  auto writer = io::PtxWriter::create(path);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  for (const PlacedScan& placed : scans) {
    if (auto appended = append_scan(*writer, placed); !appended) return appended;
  }
  return writer->publish();
}

}  // namespace isthmus::pipelines
