#include "io/scan_reader.h"

#include <utility>

#include "io/format_table.h"
#include "io/input_file.h"
#include "io/scan_name.h"

namespace isthmus::io {

Result<std::vector<ScanRef>> scans_of_file(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto format = format_of(path);
  if (!format) return tl::unexpected(std::move(format.error()));
  std::vector<ScanRef> scans = {{path, 0, {}}};
  if ((*format)->scans != nullptr) {
    auto found = (*format)->scans(path);
    if (!found) return tl::unexpected(std::move(found.error()));
    scans = std::move(*found);
  }
  for (ScanRef& scan : scans) {
    scan.name = scan_name(path.filename(), scans.size() > 1 ? std::optional(scan.index) : std::nullopt);
  }
  return scans;
}

Result<std::unique_ptr<ScanReader>> open_scan(const ScanRef& scan) {
  auto reader = open_probing(scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  return std::unique_ptr<ScanReader>(std::move(*reader));
}

Result<PointChunk> probe_scan(const ScanRef& scan, std::size_t max_points) {
  auto reader = open_probing(scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  return (*reader)->probe(max_points);
}

}  // namespace isthmus::io
