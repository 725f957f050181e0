#include "io/las/las_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/notes.h"
#include "io/record_reader.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "header fields are read in this machine's byte order");

constexpr std::size_t kSmallestHeader = 227;
constexpr std::size_t kHeaderOf14 = 375;
constexpr unsigned kCompressedBits = 0xC0;  // LASzip marks compressed point formats so

struct PointFormat {
  std::size_t bytes;   // of the format itself; records may carry extra bytes
  std::size_t colour;  // offset of red green blue (uint16); 0 = none
};
constexpr std::array<PointFormat, 11> kPointFormats = {{
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

struct LasHeader {
  unsigned major = 0, minor = 0, format = 0;
  std::size_t header_bytes = 0, record_bytes = 0;
  std::uint64_t points_begin = 0, num_points = 0;
  std::array<double, 3> scale = {}, offset = {};
};

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
  las.format = at<std::uint8_t>(raw, 104);
  las.record_bytes = at<std::uint16_t>(raw, 105);
  las.num_points = at<std::uint32_t>(raw, 107);
  if (las.minor >= 4 && las.header_bytes >= kHeaderOf14) {
    const auto wide = at<std::uint64_t>(raw, 247);
    if (wide != 0) las.num_points = wide;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    las.scale[axis] = at<double>(raw, 131 + 8 * axis);
    las.offset[axis] = at<double>(raw, 155 + 8 * axis);
  }
  return las;
}

Result<LasHeader> read_header(const InputFile& file) {
  std::array<char, kHeaderOf14> raw = {};
  const auto available = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), raw.size()));
  if (auto read = file.read_at(0, raw.data(), available); !read) return tl::unexpected(std::move(read.error()));
  if (std::memcmp(raw.data(), "LASF", 4) != 0) {
    return fail("no LAS file: it starts with " + in_quotes({raw.data(), 4}), at_byte(file.name(), 0));
  }
  if (available < kSmallestHeader) {
    return fail("the file ends inside the LAS header", at_byte(file.name(), file.size()), "the file is cut short");
  }
  return decoded(raw);
}

Result<void> check(const LasHeader& las, const std::string& file) {
  if (las.major != 1 || las.minor > 4) {
    return fail(fmt::format("unsupported format: LAS version {}.{}", las.major, las.minor), at_byte(file, 24),
                "versions 1.0 to 1.4 are read");
  }
  if ((las.format & kCompressedBits) != 0) {
    return fail("unsupported format: compressed LAS (LAZ)", at_byte(file, 104),
                "decompress it: laszip, or pdal translate");
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

RecordLayout layout_of(const LasHeader& las) {
  const std::size_t step = las.record_bytes;
  RecordLayout layout;
  layout.bytes_per_record = step;
  const auto axis = [&](std::size_t a) {
    return RecordField{ScalarType::int32, 4 * a, step, las.scale[a], las.offset[a]};
  };
  layout.x = axis(0);
  layout.y = axis(1);
  layout.z = axis(2);
  layout.intensity = RecordField{ScalarType::uint16, 12, step};
  if (const std::size_t colour = kPointFormats[las.format].colour; colour != 0) {
    layout.colour = {RecordField{ScalarType::uint16, colour, step}, RecordField{ScalarType::uint16, colour + 2, step},
                     RecordField{ScalarType::uint16, colour + 4, step}};
  }
  return layout;
}

}  // namespace

OpenedScan open_las(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto las = read_header(*file);
  if (!las) return tl::unexpected(std::move(las.error()));
  if (auto good = check(*las, file->name()); !good) return tl::unexpected(std::move(good.error()));
  ScanHeader header;
  header.format = "las";
  header.notes.push_back(fmt::format("{}{}.{}, point format {}", kLasNote, las->major, las->minor, las->format));
  return open_records(std::move(*file), std::move(header), layout_of(*las), {las->points_begin, las->num_points});
}

}  // namespace isthmus::io
