#include "pipelines/merged_export.h"

#include <algorithm>
#include <cmath>

#include "io/cloud_writer.h"
#include "io/wording.h"
#include "pipelines/export_scans.h"
#include "pipelines/occupied_voxels.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

/// What LAS multiplies intensities by: nobody says in which unit they are, but shares of one are common.
Result<float> las_intensity_scale(const io::ScanRef& scan) {
  constexpr float kMost = 65535;
  float largest = 0;
  auto reader = io::open_scan(scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  auto done = each_chunk(**reader, [&](const PointChunk& chunk) -> Result<void> {
    for (const float value : chunk.intensity) largest = std::isfinite(value) ? std::max(largest, value) : largest;
    return {};
  });
  if (!done) return tl::unexpected(std::move(done.error()));
  return largest <= 1 ? kMost : 1.0f;
}

Result<io::CloudShape> shape_of(const std::vector<SourcedScan>& scans) {
  io::CloudShape shape;
  for (const SourcedScan& scan : scans) {
    auto reader = io::open_scan(scan.placed.scan);
    if (!reader) return tl::unexpected(std::move(reader.error()));
    const ScanHeader& header = (*reader)->header();
    shape.intensity = shape.intensity || header.has_intensity;
    shape.colour = shape.colour || header.has_colour;
    if (&scan == &scans.front())
      shape.middle = (scan.placed.file_from_scan * header.local_origin_in_scan).array().round();
  }
  return shape;
}

/// Which points of a scan are written: what was measured, and with voxels what is the first in its own.
class Choice {
 public:
  Choice(const PlacedScan& placed, const ScanHeader& header, OccupiedVoxels* seen)
      : file_from_local_(placed.file_from_scan * Eigen::Translation3d(header.local_origin_in_scan)),
        // The reader's origin stands for "nothing was measured", see VoxelSampler.
        nothing_((-header.local_origin_in_scan).cast<float>()),
        seen_(seen) {}
  /// Where it lies, if it is to be written.
  std::optional<Eigen::Vector3d> place_of(const Eigen::Vector3f& p_in_local) {
    if (!p_in_local.allFinite() || p_in_local == nothing_) return std::nullopt;
    const Eigen::Vector3d place = file_from_local_ * p_in_local.cast<double>();
    if (seen_ != nullptr && !seen_->insert(place)) return std::nullopt;
    return place;
  }

 private:
  Transform file_from_local_;
  Eigen::Vector3f nothing_;
  OccupiedVoxels* seen_;
};

Result<void> append_scan(io::CloudWriter& writer, const SourcedScan& scan, float intensity_scale,
                         OccupiedVoxels* seen) {
  auto reader = io::open_scan(scan.placed.scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  Choice choice(scan.placed, (*reader)->header(), seen);
  return each_chunk(**reader, [&](const PointChunk& chunk) -> Result<void> {
    for (std::size_t i = 0; i < chunk.points.size(); ++i) {
      const auto place = choice.place_of(chunk.points[i]);
      if (!place) continue;
      io::CloudPoint point;
      point.position = *place;
      if (i < chunk.intensity.size()) point.intensity = intensity_scale * chunk.intensity[i];
      if (i < chunk.colour.size()) point.colour = chunk.colour[i];
      point.source = scan.source;
      if (auto added = writer.add(point); !added) return added;
    }
    return {};
  });
}

Result<std::uint64_t> append_station(io::E57Writer& writer, const PlacedScan& placed, OccupiedVoxels* seen) {
  const auto reader = begin_station(writer, placed);
  if (!reader) return tl::unexpected(reader.error());
  const Eigen::Vector3d origin = (*reader)->header().local_origin_in_scan;
  Choice choice(placed, (*reader)->header(), seen);
  std::uint64_t count = 0;
  PointChunk kept;
  auto done = each_chunk(**reader, [&](const PointChunk& chunk) -> Result<void> {
    kept.clear();
    for (std::size_t i = 0; i < chunk.points.size(); ++i) {
      if (!choice.place_of(chunk.points[i])) continue;
      kept.points.push_back(chunk.points[i]);
      if (i < chunk.intensity.size()) kept.intensity.push_back(chunk.intensity[i]);
      if (i < chunk.colour.size()) kept.colour.push_back(chunk.colour[i]);
    }
    count += kept.points.size();
    return writer.add(kept, origin);
  });
  if (!done) return tl::unexpected(std::move(done.error()));
  return count;
}

bool ends_in(const fs::path& path, std::string_view extension) {
  return io::lower_case(path.extension().string()) == extension;
}

Result<std::uint64_t> write_cloud(const fs::path& path, const std::vector<SourcedScan>& scans,
                                  const io::CloudShape& shape, OccupiedVoxels* seen) {
  auto writer = io::CloudWriter::create(path, shape);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  const bool las = ends_in(path, ".las") || ends_in(path, ".laz");
  for (const SourcedScan& scan : scans) {
    const auto scale = las && shape.intensity ? las_intensity_scale(scan.placed.scan) : Result<float>(1.0f);
    if (!scale) return tl::unexpected(scale.error());
    if (auto appended = append_scan(*writer, scan, *scale, seen); !appended)
      return tl::unexpected(std::move(appended.error()));
  }
  if (auto published = writer->publish(); !published) return tl::unexpected(std::move(published.error()));
  return writer->count();
}

Result<std::uint64_t> write_stations(const fs::path& path, const std::vector<SourcedScan>& scans,
                                     const io::CloudShape& shape, OccupiedVoxels* seen) {
  auto writer = io::E57Writer::create(path, shape.crs ? shape.crs->text : std::string());
  if (!writer) return tl::unexpected(std::move(writer.error()));
  std::uint64_t count = 0;
  for (const SourcedScan& scan : scans) {
    const auto appended = append_station(*writer, scan.placed, seen);
    if (!appended) return appended;
    count += *appended;
  }
  if (auto published = writer->publish(); !published) return tl::unexpected(std::move(published.error()));
  return count;
}

}  // namespace

bool knows_merged(const fs::path& path) { return ends_in(path, ".e57") || io::CloudWriter::knows(path); }

Result<std::uint64_t> export_merged(const fs::path& path, const std::vector<SourcedScan>& scans,
                                    const MergeOptions& options) {
  const auto file_of = [](const SourcedScan& scan) { return scan.placed.scan.path; };
  if (auto good = check_export(path, scans, file_of); !good) return tl::unexpected(std::move(good.error()));
  if (options.crs && (ends_in(path, ".ply") || ends_in(path, ".pcd")))
    return fail("the format has no place for a coordinate reference system", path.string(), "write .las, .laz or .e57");
  auto shape = shape_of(scans);
  if (!shape) return tl::unexpected(std::move(shape.error()));
  shape->crs = options.crs;
  std::optional<OccupiedVoxels> seen;
  if (options.voxel_m) seen.emplace(shape->middle, *options.voxel_m);
  OccupiedVoxels* const voxels = seen ? &*seen : nullptr;
  return ends_in(path, ".e57") ? write_stations(path, scans, *shape, voxels) : write_cloud(path, scans, *shape, voxels);
}

}  // namespace isthmus::pipelines
