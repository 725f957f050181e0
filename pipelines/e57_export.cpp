#include "pipelines/e57_export.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "io/e57/e57_poses.h"
#include "io/wording.h"
#include "pipelines/export_scans.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

Result<void> append_scan(io::E57Writer& writer, const PlacedScan& placed) {
  const auto reader = begin_station(writer, placed);
  if (!reader) return tl::unexpected(reader.error());
  const Eigen::Vector3d origin = (*reader)->header().local_origin_in_scan;
  return each_chunk(**reader, [&](const PointChunk& chunk) { return writer.add(chunk, origin); });
}

bool is_e57(const fs::path& path) { return io::lower_case(path.extension().string()) == ".e57"; }

Result<void> copy_e57(const fs::path& from, const fs::path& to, const std::vector<PlacedScan>& scans,
                      const std::string& coordinates) {
  const auto all = io::scans_of_file(from);
  if (!all) return tl::unexpected(all.error());
  std::vector<std::optional<Transform>> poses(all->size());
  for (const PlacedScan& placed : scans) {
    const auto k = static_cast<std::size_t>(placed.scan.index);
    if (k < poses.size()) poses[k] = placed.file_from_scan;
  }
  return io::copy_e57_with_poses(from, to, poses, io::ScansWithoutPose::left_out, coordinates);
}

Result<void> write_one(const fs::path& path, const std::vector<PlacedScan>& scans, const std::string& coordinates) {
  const auto file_of = [](const PlacedScan& placed) { return placed.scan.path; };
  if (auto good = check_export(path, scans, file_of); !good) return good;
  const fs::path& first = scans.front().scan.path;
  const bool one_file =
      std::all_of(scans.begin(), scans.end(), [&](const PlacedScan& placed) { return placed.scan.path == first; });
  if (one_file && is_e57(first)) return copy_e57(first, path, scans, coordinates);
  auto writer = io::E57Writer::create(path, coordinates);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  for (const PlacedScan& placed : scans) {
    if (auto appended = append_scan(*writer, placed); !appended) return appended;
  }
  return writer->publish();
}

}  // namespace

Result<std::unique_ptr<io::ScanReader>> begin_station(io::E57Writer& writer, const PlacedScan& placed) {
  auto reader = io::open_scan(placed.scan);
  if (!reader) return reader;
  const ScanHeader& header = (*reader)->header();
  const bool is_far = !header.local_origin_in_scan.isZero(0.0);
  auto begun =
      writer.begin_scan({placed.scan.name, {}, placed.file_from_scan, is_far, header.has_intensity, header.has_colour});
  if (!begun) return tl::unexpected(std::move(begun.error()));
  return reader;
}

Result<void> export_e57_file(const fs::path& path, const std::vector<PlacedScan>& scans,
                             const std::string& coordinates) {
  return write_one(path, scans, coordinates);
}

Result<std::vector<fs::path>> export_e57_folder(const fs::path& folder, const fs::path& base,
                                                const std::vector<PlacedScan>& scans, const std::string& coordinates) {
  std::map<fs::path, std::vector<PlacedScan>> by_file;
  for (const PlacedScan& placed : scans) by_file[placed.scan.path].push_back(placed);
  std::vector<fs::path> written;
  for (const auto& [file, its_scans] : by_file) {
    const fs::path path = (folder / file.lexically_relative(base)).replace_extension(".e57");
    if (std::find(written.begin(), written.end(), path) != written.end()) {
      return fail("two files of scans would get this name", path.string(), "export to a single file: --e57 FILE.e57");
    }
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) return fail("folder cannot be created: " + error.message(), path.parent_path().string());
    if (auto done = write_one(path, its_scans, coordinates); !done) return tl::unexpected(std::move(done.error()));
    written.push_back(path);
  }
  return written;
}

}  // namespace isthmus::pipelines
