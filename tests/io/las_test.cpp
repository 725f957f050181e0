#include "io/las/laz.h"
#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Las : public IoTest {};

struct Shape {
  int minor = 2;
  int format = 0;
  std::uint64_t claimed = 2;
  std::size_t extra_bytes = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double scale = 0.001;
};

constexpr std::size_t kFormatBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::size_t kColourAt[] = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};

void put(std::string& bytes, std::size_t at, const auto& value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::string las(const Shape& shape, const std::vector<std::array<std::int32_t, 3>>& raw, std::uint16_t colour = 0) {
  const std::size_t header_size = shape.minor == 4 ? 375 : shape.minor == 3 ? 235 : 227;
  std::string bytes(header_size, '\0');
  put(bytes, 0, std::array{'L', 'A', 'S', 'F'});
  put(bytes, 24, std::uint8_t{1});
  put(bytes, 25, static_cast<std::uint8_t>(shape.minor));
  put(bytes, 94, static_cast<std::uint16_t>(header_size));
  put(bytes, 96, static_cast<std::uint32_t>(header_size));
  put(bytes, 104, static_cast<std::uint8_t>(shape.format));
  const std::size_t size = kFormatBytes[shape.format % 11] + shape.extra_bytes;
  put(bytes, 105, static_cast<std::uint16_t>(size));
  if (shape.minor == 4) {
    put(bytes, 247, shape.claimed);
  } else {
    put(bytes, 107, static_cast<std::uint32_t>(shape.claimed));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, 131 + 8 * axis, shape.scale);
    put(bytes, 155 + 8 * axis, shape.offset[static_cast<Eigen::Index>(axis)]);
  }
  for (const auto& p : raw) {
    std::string record(size, '\x7F');
    put(record, 0, p);
    put(record, 12, std::uint16_t{321});
    if (const auto at = kColourAt[shape.format % 11]; at != 0)
      put(record, at, std::array<std::uint16_t, 3>{colour, 0, colour});
    bytes += record;
  }
  return bytes;
}

TEST_F(Las, ReadsEveryVersionAndPointFormat) {
  for (int format = 0; format <= 10; ++format) {
    for (int minor = format < 6 ? 0 : 4; minor <= 4; ++minor) {
      Shape shape{minor, format};
      shape.extra_bytes = static_cast<std::size_t>(minor);
      const auto scan = read_whole(write("a.las", las(shape, {{1000, -2000, 3500}, {0, 1, 2}}, 65535)));
      ASSERT_TRUE(scan) << error_of(scan);
      ASSERT_EQ(scan->p_in_scan.size(), 2U);
      expect_near(scan->p_in_scan[0], {1.0, -2.0, 3.5}, 1e-6);
      EXPECT_EQ(scan->chunk.intensity[0], 321.0F);
      EXPECT_EQ(scan->header.has_colour, kColourAt[format] != 0);
      if (scan->header.has_colour) {
        EXPECT_EQ(scan->chunk.colour[1], (std::array<std::uint8_t, 3>{255, 0, 255}));
      }
    }
  }
}

TEST_F(Las, ColoursOfEightBitsStoredInSixteenAreKept) {
  const auto scan = read_whole(write("a.las", las({2, 2}, {{0, 0, 0}, {0, 1, 2}}, 200)));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->chunk.colour[0][0], 200);
}

TEST_F(Las, MapCoordinatesLoseNothing) {
  Shape shape;
  shape.offset = {500000.25, 5240000.5, 0.125};
  const auto scan = read_whole(write("a.las", las(shape, {{123456, 654321, 1}, {123457, 654322, 2}})));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_GT(scan->header.local_origin_in_scan.norm(), 5e6);
  expect_near(scan->p_in_scan[0], {500123.706, 5240654.821, 0.126}, 1e-4);
  expect_near(scan->p_in_scan[1] - scan->p_in_scan[0], {0.001, 0.001, 0.001}, 1e-5);
}

TEST_F(Las, BrokenFilesAreNamed) {
  const auto error = [&](const std::string& bytes) { return error_of(read_whole(write("a.las", bytes))); };
  const std::string good = las({}, {{0, 0, 0}, {1, 1, 1}});
  EXPECT_NE(error(good.substr(0, good.size() - 1)).find("the header says 2 points, the file holds 1"),
            std::string::npos);
  EXPECT_NE(error(las({4, 6, 1ULL << 60}, {{0, 0, 0}})).find("the file holds 1"), std::string::npos);
  EXPECT_NE(error(good.substr(0, 100)).find("ends inside the LAS header"), std::string::npos);
  EXPECT_NE(error("nothing of the kind").find("no LAS file"), std::string::npos);
  EXPECT_NE(
      error(las({2, 0x80 + 3}, {{0, 0, 0}}))
          .find(has_laz() ? "the record of LASzip that says how is missing" : "unsupported format: compressed LAS"),
      std::string::npos);
  EXPECT_NE(error(las({2, 11}, {{0, 0, 0}})).find("unsupported format: LAS point format 11"), std::string::npos);
  Shape no_scale;
  no_scale.scale = 0;
  EXPECT_NE(error(las(no_scale, {{0, 0, 0}, {1, 1, 1}})).find("scale 0"), std::string::npos);
  std::string short_records = good;
  put(short_records, 105, std::uint16_t{0});
  EXPECT_NE(error(short_records).find("0 bytes per point are too few"), std::string::npos);
  EXPECT_NE(error(las({2, 0, 0}, {})).find("holds no points"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
