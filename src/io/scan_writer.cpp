#include "io/scan_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <utility>

#include "io/e57/e57_writer.h"
#include "io/output_file.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary records are written in this machine's byte order");

constexpr std::size_t kPointsPerPiece = std::size_t{1} << 15;

template <class T>
void append_bytes(std::string& out, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

struct Shape {
  bool doubles = false, intensity = false, colour = false;
};

// One binary record; the colour as three bytes (PLY) or packed into 32 bits (PCD).
void append_record(std::string& out, const PointChunk& points, std::size_t i, const Shape& shape,
                   const Eigen::Vector3d& origin, bool packed_colour) {
  const Eigen::Vector3d p = points.points[i].cast<double>() + origin;
  for (int axis = 0; axis < 3; ++axis) {
    if (shape.doubles) {
      append_bytes(out, p[axis]);
    } else {
      append_bytes(out, static_cast<float>(p[axis]));
    }
  }
  if (shape.intensity) append_bytes(out, points.intensity[i]);
  if (!shape.colour) return;
  const auto [red, green, blue] = points.colour[i];
  if (packed_colour) {
    append_bytes(out, static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
  } else {
    out += {static_cast<char>(red), static_cast<char>(green), static_cast<char>(blue)};
  }
}

void append_text(std::string& out, const PointChunk& points, std::size_t i, const Shape& shape,
                 const Eigen::Vector3d& origin) {
  const Eigen::Vector3d p = points.points[i].cast<double>() + origin;
  auto end = std::back_inserter(out);
  fmt::format_to(end, "{:.6f} {:.6f} {:.6f}", p.x(), p.y(), p.z());
  if (shape.intensity) fmt::format_to(end, " {}", points.intensity[i]);
  if (shape.colour) fmt::format_to(end, " {} {} {}", points.colour[i][0], points.colour[i][1], points.colour[i][2]);
  out += '\n';
}

std::string ply_header(std::size_t count, const Shape& shape, const WriteOptions& options) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : options.comments) header += "comment " + comment + "\n";
  header += fmt::format("element vertex {}\n", count);
  for (const char axis : {'x', 'y', 'z'})
    header += fmt::format("property {} {}\n", shape.doubles ? "double" : "float", axis);
  if (shape.intensity) header += "property float intensity\n";
  if (shape.colour) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return header + "end_header\n";
}

std::string pcd_header(std::size_t count, const Shape& shape, const WriteOptions& options) {
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& comment : options.comments) header += "# " + comment + "\n";
  const std::string size = shape.doubles ? "8" : "4";
  std::string names = "x y z", sizes = size + " " + size + " " + size, types = "F F F", counts = "1 1 1";
  const auto add = [&](const char* name, const char* type) {
    names += std::string(" ") + name;
    sizes += " 4";
    types += std::string(" ") + type;
    counts += " 1";
  };
  if (shape.intensity) add("intensity", "F");
  if (shape.colour) add("rgb", "U");
  const Eigen::Vector3d station = options.station_in_scan.value_or(Eigen::Vector3d::Zero());
  return header + fmt::format(
                      "VERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT {} {} {} 1 "
                      "0 0 0\nPOINTS {}\nDATA binary\n",
                      names, sizes, types, counts, count, station.x(), station.y(), station.z(), count);
}

Result<void> check(const std::filesystem::path& path, const PointChunk& points) {
  const auto fits = [&](std::size_t n) { return n == 0 || n == points.points.size(); };
  if (!fits(points.intensity.size()) || !fits(points.colour.size())) {
    return fail(fmt::format("{} points, {} intensities and {} colours do not belong together", points.points.size(),
                            points.intensity.size(), points.colour.size()),
                path.string());
  }
  return {};
}

Result<void> write_e57(const std::filesystem::path& path, const PointChunk& points, const Shape& shape,
                       const WriteOptions& options) {
  auto writer = E57Writer::create(path);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  const E57ScanInfo info = {path.stem().string(), {},          options.file_from_scan, shape.doubles,
                            shape.intensity,      shape.colour};
  if (auto begun = writer->begin_scan(info); !begun) return begun;
  if (auto added = writer->add(points, options.local_origin_in_scan); !added) return added;
  return writer->publish();
}

}  // namespace

Result<void> write_scan(const std::filesystem::path& path, const PointChunk& points, const WriteOptions& options) {
  if (auto fits = check(path, points); !fits) return fits;
  const std::string extension = lower_case(path.extension().string());
  const bool is_ply = extension == ".ply", is_pcd = extension == ".pcd";
  if (!is_ply && !is_pcd && extension != ".e57" && extension != ".xyz") {
    return fail("scans cannot be written as " + in_quotes(extension), path.string(), "writable: .ply .pcd .e57 .xyz");
  }
  const bool shifted = !options.local_origin_in_scan.isZero(0.0);
  const Shape shape = {options.double_coordinates.value_or(shifted), !points.intensity.empty(), !points.colour.empty()};
  if (extension == ".e57") return write_e57(path, points, shape, options);
  auto file = OutputFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  const std::size_t total = points.points.size();
  std::string piece = is_ply ? ply_header(total, shape, options) : is_pcd ? pcd_header(total, shape, options) : "";
  for (std::size_t begin = 0; begin < total || begin == 0; begin += kPointsPerPiece) {
    for (std::size_t i = begin; i < std::min(total, begin + kPointsPerPiece); ++i) {
      if (is_ply || is_pcd) {
        append_record(piece, points, i, shape, options.local_origin_in_scan, is_pcd);
      } else {
        append_text(piece, points, i, shape, options.local_origin_in_scan);
      }
    }
    if (auto written = file->write(piece); !written) return written;
    piece.clear();
  }
  return file->publish();
}

}  // namespace isthmus::io
