#include "scan/station_frame.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

const Eigen::Vector3d kStation(512345.678, 5243210.987, 432.1);
const Eigen::Vector3d kRound(512300, 5243200, 0);

TEST(StationFrame, puts_points_of_a_map_where_the_scanner_had_them) {
  ScanHeader header;
  header.local_origin_in_scan = kRound;
  header.station_in_scan = kStation;
  const StationFrame frame(header);
  EXPECT_EQ(header.local_origin_in_scan, kStation);
  PointChunk chunk;
  const Eigen::Vector3d p(3.25, -40.5, 1.125);
  chunk.points = {(p + kStation - kRound).cast<float>(), (-kRound).cast<float>()};
  frame.move(chunk);
  EXPECT_LT((chunk.points[0].cast<double>() - p).norm(), 5e-5) << "a float at 400 m has steps of 0.03 mm";
  EXPECT_TRUE(std::isnan(chunk.points[1].x())) << "the file's zero is no point";
}

TEST(StationFrame, leaves_alone_what_is_near_zero_or_has_no_station) {
  for (const bool far : {false, true}) {
    ScanHeader header;
    if (far) header.local_origin_in_scan = kRound;
    if (!far) header.station_in_scan = Eigen::Vector3d(1, 2, 3);
    const StationFrame frame(header);
    EXPECT_EQ(header.local_origin_in_scan.isZero(), !far);
    PointChunk chunk;
    chunk.points = {{5, 6, 7}, {0, 0, 0}};
    frame.move(chunk);
    EXPECT_EQ(chunk.points[0], Eigen::Vector3f(5, 6, 7));
    EXPECT_EQ(chunk.points[1], Eigen::Vector3f(0, 0, 0));
  }
}

}  // namespace
}  // namespace isthmus
