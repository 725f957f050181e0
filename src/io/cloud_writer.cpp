#include "io/cloud_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "io/wording.h"

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary records are written in this machine's byte order");

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

template <class T>
void append(std::string& out, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

/// A comment that keeps the header as long as it is with the largest count.
std::string padded(const std::string& before, const std::string& comment, const std::string& count, int times,
                   const std::string& after) {
  const std::size_t missing = std::to_string(std::numeric_limits<std::uint64_t>::max()).size() - count.size();
  return before + comment + std::string(1 + missing * static_cast<std::size_t>(times), '-') + "\n" + after;
}

std::string ply_header(std::uint64_t count, const CloudShape& shape) {
  const std::string number = std::to_string(count);
  std::string fields = "property double x\nproperty double y\nproperty double z\n";
  if (shape.intensity) fields += "property float intensity\n";
  if (shape.colour) fields += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  fields += "property ushort source\nend_header\n";
  return padded("ply\nformat binary_little_endian 1.0\n", "comment ", number, 1,
                fmt::format("element vertex {}\n", number) + fields);
}

std::string pcd_header(std::uint64_t count, const CloudShape& shape) {
  const std::string number = std::to_string(count);
  std::string names = "FIELDS x y z", sizes = "SIZE 8 8 8", types = "TYPE F F F", counts = "COUNT 1 1 1";
  const auto add = [&](const char* name, const char* size, const char* type) {
    names += name, sizes += size, types += type, counts += " 1";
  };
  if (shape.intensity) add(" intensity", " 4", " F");
  if (shape.colour) add(" rgb", " 4", " U");
  add(" source", " 2", " U");
  const std::string tail =
      fmt::format("VERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                  names, sizes, types, counts, number, number);
  return padded("# .PCD v0.7 - Point Cloud Data file format\n", "# ", number, 2, tail);
}

}  // namespace

CloudWriter::CloudWriter(OutputFile file, std::string name, Kind kind, const CloudShape& shape)
    : file_(std::make_unique<OutputFile>(std::move(file))), name_(std::move(name)), kind_(kind), shape_(shape) {
  las_.colour = shape.colour;
  las_.offset = shape.middle;
  las_.crs = shape.crs;
  low_.setConstant(std::numeric_limits<double>::infinity());
  high_ = -low_;
}

std::optional<CloudWriter::Kind> CloudWriter::kind_of(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".las") return Kind::las;
  if (extension == ".laz") return Kind::laz;
  if (extension == ".ply") return Kind::ply;
  if (extension == ".pcd") return Kind::pcd;
  return std::nullopt;
}

bool CloudWriter::knows(const std::filesystem::path& path) { return kind_of(path).has_value(); }

Result<CloudWriter> CloudWriter::create(const std::filesystem::path& path, const CloudShape& shape) {
  const auto kind = kind_of(path);
  if (!kind) return fail("clouds are written as .las, .laz, .ply or .pcd", path.string());
  auto file = OutputFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  CloudWriter writer(std::move(*file), path.string(), *kind, shape);
  if (auto begun = writer.begin(); !begun) return tl::unexpected(std::move(begun.error()));
  return writer;
}

Result<void> CloudWriter::begin() {
  if (kind_ == Kind::laz) {
    auto laz = LazStream::create(*file_, las_.format(), las_.record_bytes(), name_);
    if (!laz) return tl::unexpected(std::move(laz.error()));
    laz_ = std::move(*laz);
    las_.laz_record = laz_->record();
  }
  buffer_ = header();
  const std::uint64_t points_begin = buffer_.size();
  if (!laz_) return {};
  if (auto flushed = flush(); !flushed) return flushed;
  return laz_->begin_points(points_begin);
}

std::string CloudWriter::header() const {
  switch (kind_) {
    case Kind::las:
    case Kind::laz:
      return las_.bytes(count_, low_, high_);
    case Kind::ply:
      return ply_header(count_, shape_);
    case Kind::pcd:
      return pcd_header(count_, shape_);
  }
  return {};
}

Result<void> CloudWriter::append_las(const CloudPoint& point) {
  Eigen::Array3d stored;
  for (int k = 0; k < 3; ++k) {
    const double steps = std::round((point.position[k] - shape_.middle[k]) / kLasScale_m);
    if (!(std::abs(steps) <= std::numeric_limits<std::int32_t>::max()))
      return fail(fmt::format("a point at {:.3f} is too far from {:.3f} for LAS in steps of 0.1 mm", point.position[k],
                              shape_.middle[k]),
                  name_, "export PLY or PCD");
    append(buffer_, static_cast<std::int32_t>(steps));
    stored[k] = steps * kLasScale_m + shape_.middle[k];
  }
  low_ = low_.min(stored);
  high_ = high_.max(stored);
  append(buffer_, static_cast<std::uint16_t>(std::lround(std::clamp(point.intensity, 0.0f, 65535.0f))));
  if (las_.format() < 6) {
    append(buffer_, std::uint8_t{0x09});  // return 1 of 1
    buffer_.append(3, '\0');              // class, angle, user data
    append(buffer_, point.source);
  } else {
    append(buffer_, std::uint8_t{0x11});  // return 1 of 1
    buffer_.append(3, '\0');              // flags, class, user data
    append(buffer_, std::int16_t{0});     // angle
    append(buffer_, point.source);
    append(buffer_, 0.0);  // time
  }
  if (shape_.colour)
    for (const std::uint8_t value : point.colour) append(buffer_, static_cast<std::uint16_t>(257 * value));
  if (!laz_) return {};
  auto added = laz_->add(buffer_);
  buffer_.clear();
  return added;
}

Result<void> CloudWriter::add(const CloudPoint& point) {
  ++count_;
  if (kind_ == Kind::las || kind_ == Kind::laz) {
    if (auto done = append_las(point); !done) return done;
  } else {
    for (int k = 0; k < 3; ++k) append(buffer_, point.position[k]);
    if (shape_.intensity) append(buffer_, point.intensity);
    const auto [red, green, blue] = point.colour;
    if (shape_.colour && kind_ == Kind::pcd) append(buffer_, static_cast<std::uint32_t>(red << 16 | green << 8 | blue));
    if (shape_.colour && kind_ == Kind::ply)
      buffer_ += {static_cast<char>(red), static_cast<char>(green), static_cast<char>(blue)};
    append(buffer_, point.source);
  }
  return buffer_.size() < kBufferBytes ? Result<void>() : flush();
}

Result<void> CloudWriter::flush() {
  auto written = file_->write(buffer_);
  buffer_.clear();
  return written;
}

Result<void> CloudWriter::publish() {
  if (auto flushed = laz_ ? laz_->end() : flush(); !flushed) return flushed;
  if (auto written = file_->overwrite(0, header()); !written) return written;
  return file_->publish();
}

}  // namespace isthmus::io
