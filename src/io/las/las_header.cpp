#include "io/las/las_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/notes.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "header fields are read in this machine's byte order");

constexpr std::size_t kSmallestHeader = 227;
constexpr std::size_t kHeaderOf14 = 375;
constexpr unsigned kCompressedBits = 0xC0;

constexpr std::array<LasPointFormat, 11> kPointFormats = {{
    {20, 0},
    {28, 0},
    {26, 20},
    {34, 28},
    {57, 0},
    {63, 28},
    {30, 0},
    {36, 30},
    {38, 30},
    {59, 0},
    {67, 30},
}};

template <class T>
T at(const std::array<char, kHeaderOf14>& raw, std::size_t offset) {
  T value;
  std::memcpy(&value, raw.data() + offset, sizeof(T));
  return value;
}

LasHeader decoded(const std::array<char, kHeaderOf14>& raw) {
  LasHeader las;
  las.major = at<std::uint8_t>(raw, 24);
  las.minor = at<std::uint8_t>(raw, 25);
  las.header_bytes = at<std::uint16_t>(raw, 94);
  las.points_begin = at<std::uint32_t>(raw, 96);
  las.num_records = at<std::uint32_t>(raw, 100);
  las.format = at<std::uint8_t>(raw, 104);
  las.compressed = (las.format & kCompressedBits) != 0;
  las.format &= ~kCompressedBits;
  las.record_bytes = at<std::uint16_t>(raw, 105);
  las.num_points = at<std::uint32_t>(raw, 107);
  if (las.minor >= 4 && las.header_bytes >= kHeaderOf14) {
    const auto wide = at<std::uint64_t>(raw, 247);
    if (wide != 0) las.num_points = wide;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    las.scale[axis] = at<double>(raw, 131 + 8 * axis);
    las.offset[axis] = at<double>(raw, 155 + 8 * axis);
    las.high[axis] = at<double>(raw, 179 + 16 * axis);
    las.low[axis] = at<double>(raw, 187 + 16 * axis);
  }
  return las;
}

Result<void> check(const LasHeader& las, const std::string& file) {
  if (las.major != 1 || las.minor > 4) {
    return fail(fmt::format("unsupported format: LAS version {}.{}", las.major, las.minor), at_byte(file, 24),
                "versions 1.0 to 1.4 are read");
  }
  if (las.format >= kPointFormats.size()) {
    return fail(fmt::format("unsupported format: LAS point format {}", las.format), at_byte(file, 104),
                "0 to 10 are read");
  }
  if (las.record_bytes < kPointFormats[las.format].bytes) {
    return fail(fmt::format("{} bytes per point are too few for point format {}, which has {}", las.record_bytes,
                            las.format, kPointFormats[las.format].bytes),
                at_byte(file, 105));
  }
  if (las.header_bytes < kSmallestHeader || las.points_begin < las.header_bytes) {
    return fail(fmt::format("header of {} bytes and points at byte {} cannot be", las.header_bytes, las.points_begin),
                at_byte(file, 94));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(las.scale[axis]) || las.scale[axis] == 0.0 || !std::isfinite(las.offset[axis])) {
      return fail(fmt::format("coordinate scale {} and offset {} cannot be", las.scale[axis], las.offset[axis]),
                  at_byte(file, 131 + 8 * axis));
    }
  }
  return {};
}

}  // namespace

const LasPointFormat& LasHeader::point_format() const { return kPointFormats[format]; }

Result<LasHeader> read_las_header(const InputFile& file) {
  std::array<char, kHeaderOf14> raw = {};
  const auto available = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), raw.size()));
  if (auto read = file.read_at(0, raw.data(), available); !read) return tl::unexpected(std::move(read.error()));
  if (std::memcmp(raw.data(), "LASF", 4) != 0) {
    return fail("no LAS file: it starts with " + in_quotes({raw.data(), 4}), at_byte(file.name(), 0));
  }
  if (available < kSmallestHeader) {
    return fail("the file ends inside the LAS header", at_byte(file.name(), file.size()), "the file is cut short");
  }
  LasHeader las = decoded(raw);
  if (auto good = check(las, file.name()); !good) return tl::unexpected(std::move(good.error()));
  return las;
}

ScanHeader scan_header_of(const LasHeader& las) {
  ScanHeader header;
  header.format = las.compressed ? "laz" : "las";
  header.notes.push_back(fmt::format("{}{}.{}, point format {}", kLasNote, las.major, las.minor, las.format));
  return header;
}

}  // namespace isthmus::io
