#include "io/scan_writer.h"

#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Writer : public IoTest {};

PointChunk some_points(std::size_t n) {
  PointChunk chunk;
  for (std::size_t i = 0; i < n; ++i) {
    const auto f = static_cast<float>(i % 1000);
    chunk.points.emplace_back(f * 0.25F, -f, 1.0F / (1.0F + f));
    chunk.intensity.push_back(f * 0.5F);
    chunk.colour.push_back({static_cast<std::uint8_t>(i), 2, 255});
  }
  return chunk;
}

TEST_F(Writer, WhatIsWrittenIsReadBack) {
  const PointChunk points = some_points(100000);  // several pieces
  for (const std::string extension : {".ply", ".pcd"}) {
    WriteOptions options;
    options.station_in_scan = Eigen::Vector3d(1.5, 0, 2);
    options.comments = {"made by a test"};
    const auto path = folder / ("scan" + extension);
    const auto written = write_scan(path, points, options);
    ASSERT_TRUE(written) << error_of(written);
    const auto scan = read_whole({path, 0, {}}, 4096);
    ASSERT_TRUE(scan) << error_of(scan);
    EXPECT_TRUE(scan->chunk.points == points.points);
    EXPECT_TRUE(scan->chunk.intensity == points.intensity);
    EXPECT_TRUE(scan->chunk.colour == points.colour);
    EXPECT_EQ(scan->header.station_in_scan.has_value(), extension == ".pcd");
  }
}

TEST_F(Writer, AShiftedScanIsWrittenInDoubles) {
  WriteOptions options;
  options.local_origin_in_scan = {500000, 5240000, 0};
  for (const std::string extension : {".ply", ".pcd"}) {
    const auto path = folder / ("scan" + extension);
    ASSERT_TRUE(write_scan(path, some_points(50), options));
    const auto scan = read_whole(path);
    ASSERT_TRUE(scan) << error_of(scan);
    expect_near(scan->p_in_scan[3], {500000.75, 5239997.0, 0.25}, 1e-5);
  }
}

TEST_F(Writer, RefusesUnknownExtensionsAndMismatchedArraysAndLeavesNothing) {
  EXPECT_NE(error_of(write_scan(folder / "scan.las", some_points(1))).find("cannot be written as '.las'"),
            std::string::npos);
  PointChunk points = some_points(3);
  points.intensity.pop_back();
  EXPECT_NE(error_of(write_scan(folder / "scan.ply", points)).find("do not belong together"), std::string::npos);
  EXPECT_NE(error_of(write_scan(folder / "missing" / "scan.ply", some_points(1))).find("cannot be created"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace isthmus::io::testing
