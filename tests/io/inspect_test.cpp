#include "io/inspect.h"

#include <cmath>
#include <limits>

#include "io/scan_writer.h"
#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Inspect : public IoTest {};

TEST_F(Inspect, SaysWhatAScanHolds) {
  PointChunk grid;  // a tilted plane with points every 0.05 m, and things that must not disturb
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 300; ++j) {
      grid.points.emplace_back(0.05F * static_cast<float>(i), 0.04F * static_cast<float>(j),
                               0.03F * static_cast<float>(j));
    }
  }
  grid.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  for (int k = 0; k < 500; ++k) grid.points.emplace_back(0.0F, 0.0F, 0.0F);
  for (std::size_t i = 0; i < grid.points.size(); ++i) grid.intensity.push_back(static_cast<float>(i % 11) - 2.0F);
  WriteOptions options;
  options.local_origin_in_scan = {500000, 5240000, 0};
  options.station_in_scan = Eigen::Vector3d(500001, 5240002, 1.5);
  const auto path = folder / "a.pcd";
  ASSERT_TRUE(write_scan(path, grid, options));
  const auto summary = inspect_scan({path, 0, {}});
  ASSERT_TRUE(summary) << error_of(summary);
  EXPECT_EQ(summary->header.format, "pcd");
  EXPECT_EQ(summary->num_read, 60501U);
  EXPECT_EQ(summary->num_finite, 60500U);
  expect_near(summary->extent_in_scan->min(), {500000, 5240000, 0}, 1e-4);
  expect_near(summary->extent_in_scan->max(), {500009.95, 5240011.96, 8.97}, 1e-4);
  ASSERT_TRUE(summary->spacing_m.has_value());
  EXPECT_NEAR(*summary->spacing_m, 0.05, 0.001);
  EXPECT_EQ(summary->intensity_range, (std::pair<float, float>(-2.0F, 8.0F)));
  expect_near(*summary->header.station_in_scan, {500001, 5240002, 1.5}, 0);
}

TEST_F(Inspect, DegenerateScansHaveNoSpacing) {
  for (const char* text : {"1 2 3\n", "1 2 3\n1 2 3\n", "nan nan nan\n"}) {
    const auto summary = inspect_scan({write("a.xyz", text), 0, {}});
    ASSERT_TRUE(summary) << error_of(summary);
    EXPECT_FALSE(summary->spacing_m.has_value()) << text;
    EXPECT_EQ(summary->extent_in_scan.has_value(), text[0] == '1');
    EXPECT_FALSE(summary->intensity_range.has_value());
  }
}

TEST_F(Inspect, SpacingAgreesWithTheDistancesOfAllPoints) {
  PointChunk random;  // uneven: dense near the origin
  std::uint32_t state = 1;
  const auto next = [&] { return static_cast<float>((state = state * 1664525U + 1013904223U) >> 8) / 16777216.0F; };
  for (int i = 0; i < 4000; ++i) {
    const float r = 1.0F + 9.0F * next() * next(), a = 6.28F * next();
    random.points.emplace_back(r * std::cos(a), r * std::sin(a), 0.0F);
  }
  std::vector<float> nearest;
  for (std::size_t i = 0; i < random.points.size(); ++i) {
    float sq = 1e9F;
    for (std::size_t j = 0; j < random.points.size(); ++j) {
      if (i != j) sq = std::min(sq, (random.points[i] - random.points[j]).squaredNorm());
    }
    nearest.push_back(std::sqrt(sq));
  }
  std::nth_element(nearest.begin(), nearest.begin() + 2000, nearest.end());
  const auto path = folder / "a.ply";
  ASSERT_TRUE(write_scan(path, random));
  const auto summary = inspect_scan({path, 0, {}});
  ASSERT_TRUE(summary && summary->spacing_m) << error_of(summary);
  EXPECT_NEAR(*summary->spacing_m / nearest[2000], 1.0, 0.25);
}

}  // namespace
}  // namespace isthmus::io::testing
