#include "io/kitti/kitti_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "io/record_reader.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kBytesPerPoint = 16;
constexpr float kFarthest_m = 1e4F;  // no lidar on a car reaches so far

bool is_plausible(const PointChunk& probe) {
  const auto odd = std::count_if(probe.points.begin(), probe.points.end(), [](const Eigen::Vector3f& p) {
    return !p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest_m;
  });
  return 2 * static_cast<std::size_t>(odd) <= probe.points.size();
}

}  // namespace

OpenedScan open_kitti(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  const std::string name = file->name();
  if (file->size() % kBytesPerPoint != 0) {
    return fail(fmt::format("{} bytes are no multiple of 16: no KITTI scan, or cut short", file->size()), name);
  }
  RecordLayout layout;
  layout.bytes_per_record = kBytesPerPoint;
  layout.swap_bytes = std::endian::native != std::endian::little;
  layout.x = {ScalarType::float32, 0, kBytesPerPoint};
  layout.y = {ScalarType::float32, 4, kBytesPerPoint};
  layout.z = RecordField{ScalarType::float32, 8, kBytesPerPoint};
  layout.intensity = RecordField{ScalarType::float32, 12, kBytesPerPoint};
  ScanHeader header;
  header.format = "kitti";
  const RecordBlock block = {0, file->size() / kBytesPerPoint};
  auto reader = open_records(std::move(*file), std::move(header), layout, block);
  if (!reader) return reader;
  auto probe = (*reader)->probe(kOpeningSample);
  if (!probe) return tl::unexpected(std::move(probe.error()));
  const bool far = !(*reader)->header().local_origin_in_scan.isZero(0.0);
  if (far || !is_plausible(*probe)) {
    return fail("its numbers are no coordinates: no KITTI scan (float32 x y z reflectance)", name);
  }
  return reader;
}

}  // namespace isthmus::io
