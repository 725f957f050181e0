#include <pcl/io/lzf.h>

#include <cmath>

#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Pcd : public IoTest {};

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   const std::string& count, std::uint64_t points, const std::string& data,
                   const std::string& viewpoint = "0 0 0 1 0 0 0") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type + "\nCOUNT " + count +
         "\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT " + viewpoint + "\nPOINTS " +
         std::to_string(points) + "\nDATA " + data + "\n";
}

TEST_F(Pcd, ReadsAsciiWithWideFieldsAndViewpoint) {
  const auto scan = read_whole(
      write("a.pcd", header("h x y z intensity", "4 4 4 4 4", "F F F F F", "2 1 1 1 1", 2, "ascii", "1 2 3 1 0 0 0") +
                         "9 9 1 2 3 0.5\r\n9 9 nan nan nan 0.25\r\n"));
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 2U);
  expect_near(scan->p_in_scan[0], {1, 2, 3}, 0);
  EXPECT_TRUE(std::isnan(scan->p_in_scan[1].z()));
  EXPECT_EQ(scan->chunk.intensity[1], 0.25F);
  ASSERT_TRUE(scan->header.station_in_scan.has_value());
  expect_near(*scan->header.station_in_scan, {1, 2, 3}, 0);
}

TEST_F(Pcd, TheDefaultViewpointIsNoStation) {
  const auto scan = read_whole(write("a.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 1, "ascii") + "1 2 3\n"));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_FALSE(scan->header.station_in_scan.has_value());
}

// 3 points: x y z (float or double), two shorts, packed colour.
std::string fields_of_point(int i) {
  std::string out = bytes_of_value(1.0F + static_cast<float>(i)) + bytes_of_value(2.0F) + bytes_of_value(3.0F);
  return out + bytes_of_value<short>(5) + bytes_of_value<short>(6) + bytes_of_value(0x00FF8001U);
}

void expect_three_points(const Result<WholeScan>& scan) {
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 3U);
  expect_near(scan->p_in_scan[2], {3, 2, 3}, 0);
  EXPECT_EQ(scan->chunk.colour[1], (std::array<std::uint8_t, 3>{255, 128, 1}));
}

TEST_F(Pcd, ReadsBinary) {
  std::string text = header("x y z s rgb", "4 4 4 2 4", "F F F I F", "1 1 1 2 1", 3, "binary");
  for (int i = 0; i < 3; ++i) text += fields_of_point(i);
  expect_three_points(read_whole(write("a.pcd", text)));
}

std::string compressed(const std::string& columns) {
  std::string packed(columns.size() * 2 + 64, '\0');
  const unsigned size = pcl::lzfCompress(columns.data(), static_cast<unsigned>(columns.size()), packed.data(),
                                         static_cast<unsigned>(packed.size()));
  return bytes_of_value(size) + bytes_of_value(static_cast<std::uint32_t>(columns.size())) + packed.substr(0, size);
}

TEST_F(Pcd, ReadsCompressed) {
  std::string columns;
  const int sizes[] = {4, 4, 4, 4, 4};  // the two shorts are one field
  for (int f = 0, offset = 0; f < 5; offset += sizes[f++]) {
    for (int i = 0; i < 3; ++i) columns += fields_of_point(i).substr(offset, sizes[f]);
  }
  const std::string text =
      header("x y z s rgb", "4 4 4 2 4", "F F F I F", "1 1 1 2 1", 3, "binary_compressed") + compressed(columns);
  const auto path = write("a.pcd", text);
  expect_three_points(read_whole(path));
  EXPECT_EQ(probe_scan({path, 0, {}}, 2)->points.size(), 2U);
  const auto cut = error_of(read_whole(write("b.pcd", text.substr(0, text.size() - 3))));
  EXPECT_NE(cut.find("the compressed block should be"), std::string::npos) << cut;
  std::string damaged = text;
  damaged[text.find("compressed\n") + 11 + 8] = '\xFF';  // a reference to bytes before the first one
  EXPECT_NE(error_of(read_whole(write("c.pcd", damaged))).find("damaged"), std::string::npos);
}

TEST_F(Pcd, WrongCountsAreRefused) {
  const std::string body = bytes_of_value(1.0F) + bytes_of_value(2.0F) + bytes_of_value(3.0F);
  const auto error = [&](std::uint64_t claimed, const std::string& data, const std::string& rest) {
    return error_of(read_whole(write("a.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", claimed, data) + rest)));
  };
  EXPECT_NE(error(2, "binary", body + "12345").find("the header says 2 points, the file holds 1"), std::string::npos);
  EXPECT_NE(error(99999999999999999ULL, "binary", body).find("the file holds 1"), std::string::npos);
  EXPECT_NE(error(99999999999999999ULL, "ascii", "1 2 3\n").find("the header says 99999999999999999"),
            std::string::npos);
  EXPECT_NE(error(99999999999999999ULL, "binary_compressed", compressed(body)).find("the header says"),
            std::string::npos);
  EXPECT_NE(
      error(357913941, "binary_compressed", bytes_of_value(12U) + bytes_of_value(4294967292U) + body).find("too short"),
      std::string::npos);
  EXPECT_NE(error(2, "ascii", "1 2 3\n").find("the header says 2 points, the file holds 1"), std::string::npos);
  EXPECT_NE(error(0, "ascii", "").find("holds no points"), std::string::npos);
}

TEST_F(Pcd, BadHeadersAreNamed) {
  const auto error = [&](const std::string& text) { return error_of(read_whole(write("a.pcd", text))); };
  EXPECT_NE(error("1 2 3\n4 5 6\n").find("line 1: no PCD header: '1 2 3'"), std::string::npos);
  EXPECT_NE(error("VERSION 0.7\n").find("no DATA line"), std::string::npos);
  EXPECT_NE(error(header("x y z", "4 4", "F F F", "1 1 1", 1, "ascii")).find("3 FIELDS, 2 SIZE"), std::string::npos);
  EXPECT_NE(error(header("x y z", "4 4 3", "F F F", "1 1 1", 1, "ascii")).find("unknown type 'F3'"), std::string::npos);
  EXPECT_NE(error(header("a b z", "4 4 4", "F F F", "1 1 1", 1, "ascii")).find("no fields x and y"), std::string::npos);
  EXPECT_NE(error(header("x y z", "4 4 4", "F F F", "1 1 1", 1, "zip")).find("unknown DATA kind 'zip'"),
            std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
