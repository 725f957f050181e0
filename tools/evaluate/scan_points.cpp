#include "evaluate/scan_points.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "io/scan_reader.h"

namespace isthmus::evaluate {
namespace {

constexpr std::size_t kChunk = 1 << 18;
constexpr double kCentroidVoxelsPerExtent = 200.0;

/// "folder/site.ptx#2" -> the file and 2, unless a file of that very name exists.
io::ScanRef scan_ref(const std::filesystem::path& folder, const std::string& name) {
  io::ScanRef ref{folder / name, 0, name};
  const std::size_t hash = name.rfind('#');
  std::error_code code;
  if (hash == std::string::npos || std::filesystem::exists(ref.path, code)) return ref;
  int index = 0;
  const auto [end, error] = std::from_chars(name.data() + hash + 1, name.data() + name.size(), index);
  if (error == std::errc() && end == name.data() + name.size())
    ref.path = folder / name.substr(0, hash), ref.index = index;
  return ref;
}

std::int64_t key_of(const Eigen::Vector3d& p, double voxel_m) {
  const auto k = [&](int axis) { return static_cast<std::int64_t>(std::floor(p[axis] / voxel_m)); };
  return (k(0) << 42) ^ ((k(1) & 0x1fffff) << 21) ^ (k(2) & 0x1fffff);
}

}  // namespace

Result<Points> load_points(const std::filesystem::path& folder, const std::string& name) {
  Result<std::unique_ptr<io::ScanReader>> reader = io::open_scan(scan_ref(folder, name));
  if (!reader) return tl::unexpected(reader.error());
  const Eigen::Vector3d origin = (*reader)->header().local_origin_in_scan;
  Points points;
  for (io::PointChunk chunk;;) {
    if (Result<void> read = (*reader)->read(chunk, kChunk); !read) return tl::unexpected(read.error());
    if (chunk.points.empty()) break;
    for (const Eigen::Vector3f& p : chunk.points)
      if (p.allFinite()) points.push_back(p.cast<double>() + origin);
  }
  if (points.empty()) return fail("holds no finite point", (folder / name).string());
  return points;
}

Points voxel_sampled(const Points& points, double voxel_m) {
  std::vector<std::pair<std::int64_t, std::uint32_t>> keys;
  keys.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    keys.emplace_back(key_of(points[i], voxel_m), static_cast<std::uint32_t>(i));
  std::sort(keys.begin(), keys.end());
  Points out;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (i == 0 || keys[i].first != keys[i - 1].first) out.push_back(points[keys[i].second]);
  return out;
}

Eigen::Vector3d sampled_centroid(const Points& points) {
  Eigen::Vector3d low = points.front(), high = low;
  for (const Eigen::Vector3d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double extent = (high - low).maxCoeff();
  const Points sampled = extent > 0 ? voxel_sampled(points, extent / kCentroidVoxelsPerExtent) : Points{points.front()};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : sampled) sum += p - low;  // small numbers before the sum
  return low + sum / static_cast<double>(sampled.size());
}

}  // namespace isthmus::evaluate
