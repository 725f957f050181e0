#include "simulate/ply_writer.h"

#include <fmt/format.h>

#include <cstring>

#include "base/atomic_file.h"

namespace isthmus::sim {

Result<void> write_ply(const std::filesystem::path& path, const io::PointChunk& points) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float intensity\nend_header\n",
      points.points.size());
  const std::size_t header = bytes.size();
  bytes.resize(header + 16 * points.points.size());
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    std::memcpy(bytes.data() + header + 16 * i, points.points[i].data(), 12);
    std::memcpy(bytes.data() + header + 16 * i + 12, &points.intensity[i], 4);
  }
  return write_file_atomically(path, bytes);
}

}  // namespace isthmus::sim
