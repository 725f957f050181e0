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

Result<void> append_scan(io::CloudWriter& writer, const SourcedScan& scan, float intensity_scale,
                         OccupiedVoxels* seen) {
  auto reader = io::open_scan(scan.placed.scan);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  const ScanHeader& header = (*reader)->header();
  const Transform file_from_local = scan.placed.file_from_scan * Eigen::Translation3d(header.local_origin_in_scan);
  // The reader's origin stands for "nothing was measured", see VoxelSampler.
  const Eigen::Vector3f nothing = (-header.local_origin_in_scan).cast<float>();
  return each_chunk(**reader, [&](const PointChunk& chunk) -> Result<void> {
    for (std::size_t i = 0; i < chunk.points.size(); ++i) {
      if (!chunk.points[i].allFinite() || chunk.points[i] == nothing) continue;
      io::CloudPoint point;
      point.position = file_from_local * chunk.points[i].cast<double>();
      if (seen != nullptr && !seen->insert(point.position)) continue;
      if (i < chunk.intensity.size()) point.intensity = intensity_scale * chunk.intensity[i];
      if (i < chunk.colour.size()) point.colour = chunk.colour[i];
      point.source = scan.source;
      if (auto added = writer.add(point); !added) return added;
    }
    return {};
  });
}

}  // namespace

Result<std::uint64_t> export_merged(const fs::path& path, const std::vector<SourcedScan>& scans,
                                    std::optional<double> voxel_m) {
  const auto file_of = [](const SourcedScan& scan) { return scan.placed.scan.path; };
  if (auto good = check_export(path, scans, file_of); !good) return tl::unexpected(std::move(good.error()));
  auto shape = shape_of(scans);
  if (!shape) return tl::unexpected(std::move(shape.error()));
  auto writer = io::CloudWriter::create(path, *shape);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  std::optional<OccupiedVoxels> seen;
  if (voxel_m) seen.emplace(shape->middle, *voxel_m);
  const bool las = io::lower_case(path.extension().string()) == ".las";
  for (const SourcedScan& scan : scans) {
    const auto scale = las && shape->intensity ? las_intensity_scale(scan.placed.scan) : Result<float>(1.0f);
    if (!scale) return tl::unexpected(scale.error());
    auto appended = append_scan(*writer, scan, *scale, seen ? &*seen : nullptr);
    if (!appended) return tl::unexpected(std::move(appended.error()));
  }
  if (auto published = writer->publish(); !published) return tl::unexpected(std::move(published.error()));
  return writer->count();
}

}  // namespace isthmus::pipelines
