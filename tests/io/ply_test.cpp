#include <cmath>
#include <limits>

#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Ply : public IoTest {};

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string ascii(const std::string& body, int count, const std::string& properties = kXyz) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) + "\n" + properties + "end_header\n" + body;
}

TEST_F(Ply, ReadsAsciiWithColoursIntensityAndForeignColumns) {
  const auto path =
      write("a.ply", ascii("1 2 3 9 7.5 255 128 0\n-1e-3 +2 .5 9 0 0 0 1\n", 2,
                           kXyz + "property int label\nproperty float scalar_Intensity\nproperty uchar red\n"
                                  "property uchar green\nproperty uchar blue\n"));
  const auto scan = read_whole(path);
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->header.format, "ply");
  EXPECT_EQ(scan->header.num_points, 2U);
  ASSERT_EQ(scan->p_in_scan.size(), 2U);
  expect_near(scan->p_in_scan[1], {-1e-3, 2, 0.5}, 1e-7);
  EXPECT_EQ(scan->chunk.intensity[0], 7.5F);
  EXPECT_EQ(scan->chunk.colour[0], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_FALSE(scan->header.station_in_scan.has_value());
}

TEST_F(Ply, ReadsCrLfBlankLinesUnknownHeaderLinesAndNan) {
  std::string text = ascii("1 2 3\n\nnan nan nan\n4 5 6", 3, "bye\n" + kXyz + "comment c\nobj_info o\n");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.replace(at, 1, "\r\n");
  const auto scan = read_whole(write("a.ply", text));
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 3U);
  EXPECT_TRUE(std::isnan(scan->p_in_scan[1].x()));
  expect_near(scan->p_in_scan[2], {4, 5, 6}, 0);
  ASSERT_EQ(scan->header.notes.size(), 1U);
  EXPECT_NE(scan->header.notes[0].find("bye"), std::string::npos);
}

std::string binary(bool big, const std::string& before, const std::string& between, int count,
                   const std::string& after) {
  return std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + before + "element vertex " +
         std::to_string(count) + "\n" + between + after + "end_header\n";
}

TEST_F(Ply, ReadsBothByteOrdersWithDoublesAndShortColours) {
  for (const bool big : {false, true}) {
    std::string text = binary(big, "",
                              "property double x\nproperty double y\nproperty double z\nproperty ushort red\n"
                              "property ushort green\nproperty ushort blue\n",
                              3, "");
    for (int i = 0; i < 3; ++i) {
      for (const double v : {0.1 + i, -2.5, 1e3}) text += bytes_of_value(v, big);
      for (const int v : {65535, 0, 32896}) text += bytes_of_value(static_cast<std::uint16_t>(v), big);
    }
    const auto scan = read_whole(write("a.ply", text));
    ASSERT_TRUE(scan) << error_of(scan);
    ASSERT_EQ(scan->p_in_scan.size(), 3U);
    expect_near(scan->p_in_scan[2], {2.1, -2.5, 1e3}, 1e-4);
    EXPECT_EQ(scan->chunk.colour[0], (std::array<std::uint8_t, 3>{255, 0, 128}));
  }
}

TEST_F(Ply, SkipsElementsAndListsBeforeAndAmongTheVertices) {
  for (const bool big : {false, true}) {
    std::string text =
        binary(big, "element camera 2\nproperty int a\nelement strip 2\nproperty list uchar int i\nproperty short s\n",
               "property list ushort float w\n" + kXyz + "property list uchar uchar t\n", 2,
               "element face 1\nproperty list uchar int vertex_indices\n");
    text += bytes_of_value(7, big) + bytes_of_value(8, big);
    text += bytes_of_value<std::uint8_t>(2, big) + bytes_of_value(1, big) + bytes_of_value(2, big) +
            bytes_of_value<short>(5, big);
    text += bytes_of_value<std::uint8_t>(0, big) + bytes_of_value<short>(5, big);
    for (int i = 0; i < 2; ++i) {
      text += bytes_of_value(static_cast<std::uint16_t>(i), big);
      for (int k = 0; k < i; ++k) text += bytes_of_value(99.0F, big);
      for (int k = 1; k <= 3; ++k) text += bytes_of_value(static_cast<float>(k + 10 * i), big);
      text += bytes_of_value<std::uint8_t>(1, big) + "?";
    }
    text += bytes_of_value<std::uint8_t>(3, big) + std::string(12, 'x');
    const auto path = write("a.ply", text);
    const auto scan = read_whole(path);
    ASSERT_TRUE(scan) << error_of(scan);
    ASSERT_EQ(scan->p_in_scan.size(), 2U);
    expect_near(scan->p_in_scan[0], {1, 2, 3}, 0);
    expect_near(scan->p_in_scan[1], {11, 12, 13}, 0);
    EXPECT_EQ(probe_scan({path, 0, {}}, 10)->points.size(), 2U);
  }
}

TEST_F(Ply, AsciiListsShiftTheColumnsBehindThem) {
  const auto path = write("a.ply",
                          "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int v\nelement vertex 2\n"
                          "property list uchar int l\n" +
                              kXyz + "end_header\n3 0 1 2\n0\n2 9 9 1 2 3\n0 4 5 6\n");
  const auto scan = read_whole(path);
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 2U);
  expect_near(scan->p_in_scan[0], {1, 2, 3}, 0);
  expect_near(scan->p_in_scan[1], {4, 5, 6}, 0);
}

TEST_F(Ply, KeepsMapCoordinatesBelowAMillimetre) {
  const Eigen::Vector3d a(500123.4567, 5240987.6543, 431.1234), b(500130.0001, 5240980.0009, 430.5);
  std::string body = binary(false, "", "property double x\nproperty double y\nproperty double z\n", 2, "");
  for (const auto& p : {a, b}) {
    for (int k = 0; k < 3; ++k) body += bytes_of_value(p[k]);
  }
  const std::string text = ascii("500123.4567 5240987.6543 431.1234\n500130.0001 5240980.0009 430.5\n", 2);
  for (const auto& path : {write("b.ply", body), write("a.ply", text)}) {
    const auto scan = read_whole(path);
    ASSERT_TRUE(scan) << error_of(scan);
    expect_near(scan->header.local_origin_in_scan, {500100, 5241000, 0}, 0);
    expect_near(scan->p_in_scan[0], a, 1e-4);
    expect_near(scan->p_in_scan[1], b, 1e-4);
  }
}

TEST_F(Ply, CutShortFilesSayHowManyPointsTheyHold) {
  std::string text = binary(false, "", kXyz, 4, "");
  text += std::string(3 * 12 + 5, '\1');
  EXPECT_NE(error_of(read_whole(write("b.ply", text))).find("the header says 4 points, the file holds 3"),
            std::string::npos);
  const auto missing = error_of(read_whole(write("a.ply", ascii("1 2 3\n4 5 6\n", 3))));
  EXPECT_NE(missing.find("the header says 3 points, the file holds 2"), std::string::npos) << missing;
  const auto half = error_of(read_whole(write("h.ply", ascii("1 2 3\n4 5", 2))));
  EXPECT_NE(half.find("line 9: the last line is no whole point: '4 5'"), std::string::npos) << half;
}

TEST_F(Ply, HugeClaimsAreRefusedWithoutMemory) {
  const std::string claim = "element vertex 18446744073709551615\n";
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const std::string list : {"", "property list int int l\n"}) {
      const auto text = "ply\nformat " + format + " 1.0\n" + claim + kXyz + list + "end_header\n1 2 3\n";
      EXPECT_NE(error_of(read_whole(write("a.ply", text))).find("the header says 18446744073709551615"),
                std::string::npos);
    }
    const auto before = "ply\nformat " + format +
                        " 1.0\nelement face 9999999999999\nproperty list uint double l\nelement vertex 1\n" + kXyz +
                        "end_header\n1 2 3\n";
    EXPECT_NE(error_of(read_whole(write("c.ply", before))).find("the header says 9999999999999 elements 'face'"),
              std::string::npos);
  }
}

TEST_F(Ply, BadHeadersAreNamed) {
  const auto error = [&](const std::string& text) { return error_of(read_whole(write("a.ply", text))); };
  EXPECT_NE(error("plx\n").find("line 1: no PLY file"), std::string::npos);
  EXPECT_NE(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty flaot x\n")
                .find("line 4: unknown property type 'flaot'"),
            std::string::npos);
  EXPECT_NE(error("ply\nformat ascii 1.0\nelement vertex -1\n").find("'-1' is no count"), std::string::npos);
  EXPECT_NE(error("ply\nformat ebcdic 1.0\n").find("unknown format 'ebcdic'"), std::string::npos);
  EXPECT_NE(error("ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz).find("no end_header"), std::string::npos);
  EXPECT_NE(error("ply\nformat ascii 1.0\nelement point 1\n" + kXyz + "end_header\n").find("no vertex element"),
            std::string::npos);
  EXPECT_NE(
      error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float q\nend_header\n1\n").find("no properties x and y"),
      std::string::npos);
  EXPECT_NE(error(ascii("", 0)).find("holds no points"), std::string::npos);
  EXPECT_NE(error(ascii("1 2 3\n1 zwei 3\n", 2)).find("line 9: the last line is no whole point: '1 zwei 3'"),
            std::string::npos);
  EXPECT_NE(error(ascii("1 2 3\n1 zwei 3\n4 5 6\n", 3)).find("line 9: this line is no point: '1 zwei 3'"),
            std::string::npos);
  EXPECT_NE(error(std::string(3000, '\0')).find("no PLY file"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
