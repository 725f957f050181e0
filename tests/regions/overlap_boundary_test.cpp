#include "regions/overlap_boundary.h"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

constexpr int kSide = 10;
constexpr float kReach = 1.5f;  // the eight points around one of a square grid

std::vector<Eigen::Vector3f> square_grid() {
  std::vector<Eigen::Vector3f> points;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0f);
  return points;
}

std::vector<std::uint32_t> all_of(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint32_t> all(points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

TEST(OverlapBoundary, IsTheLastRowInside) {
  const auto points = square_grid();
  std::vector<std::uint8_t> inside;
  std::vector<std::uint32_t> sample;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    inside.push_back(points[i].x() < 6);
    if (inside.back()) sample.push_back(i);
  }
  const auto marks = at_overlap_boundary(points, inside, sample, kReach);
  ASSERT_EQ(marks.size(), sample.size());
  for (std::size_t k = 0; k < sample.size(); ++k)
    EXPECT_EQ(marks[k], points[sample[k]].x() == 5) << points[sample[k]].transpose();
}

TEST(OverlapBoundary, WhereTheScanItselfEndsThereIsNone) {
  const auto points = square_grid();
  const std::vector<std::uint8_t> inside(points.size(), 1);
  for (const std::uint8_t mark : at_overlap_boundary(points, inside, all_of(points), kReach)) EXPECT_EQ(mark, 0);
}

TEST(OverlapBoundary, OneOddPointMakesNone) {
  const auto points = square_grid();
  std::vector<std::uint8_t> inside(points.size(), 1);
  inside[5 * kSide + 5] = 0;
  for (const std::uint8_t mark : at_overlap_boundary(points, inside, all_of(points), kReach)) EXPECT_EQ(mark, 0);
}

TEST(OverlapBoundary, OfNothingIsNothing) {
  EXPECT_TRUE(at_overlap_boundary({}, {}, {}, 1).empty());
  const std::vector<Eigen::Vector3f> one{{1, 2, 3}};
  const std::vector<std::uint8_t> inside{1};
  EXPECT_EQ(at_overlap_boundary(one, inside, all_of(one), 1), std::vector<std::uint8_t>{0});
}

}  // namespace
}  // namespace isthmus
