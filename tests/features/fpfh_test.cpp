#include "features/fpfh.h"

#include <gtest/gtest.h>

#include <numeric>

#include "pairwise/synthetic_scene.h"
#include "pairwise/threads.h"

namespace isthmus {
namespace {

using Points = testing::Points;

struct Cloud {
  Points points, normals;
};

// A bumpy surface with its exact normals.
Cloud bumps(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = rng.uniform(-1, 1), y = rng.uniform(-1, 1);
    cloud.points.push_back(Eigen::Vector3d(x, y, 0.3 * std::sin(4 * x) * std::cos(3 * y)).cast<float>());
    cloud.normals.push_back(
        Eigen::Vector3d(-1.2 * std::cos(4 * x) * std::cos(3 * y), 0.9 * std::sin(4 * x) * std::sin(3 * y), 1)
            .normalized()
            .cast<float>());
  }
  return cloud;
}

std::vector<std::uint32_t> first(std::size_t n) {
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

double block_sum(const std::vector<float>& rows, std::size_t row, int block) {
  double sum = 0;
  for (int b = 0; b < 11; ++b) sum += static_cast<double>(rows[row * kFpfhDimension + block * 11 + b]);
  return sum;
}

TEST(Fpfh, BlocksSumToOne) {
  const Cloud cloud = bumps(500, 1);
  const auto all = first(500), queries = first(100);
  const auto rows = fpfh(cloud.points, cloud.normals, all, queries, 0.3f);
  ASSERT_EQ(rows.size(), 100 * kFpfhDimension);
  for (std::size_t q = 0; q < 100; ++q)
    for (int block = 0; block < 3; ++block) EXPECT_NEAR(block_sum(rows, q, block), 1, 1e-5);
}

TEST(Fpfh, APlaneFillsTheMiddleBins) {
  Cloud plane;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y) {
      plane.points.emplace_back(0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0.0f);
      plane.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  const auto all = first(400), queries = std::vector<std::uint32_t>{210};
  const auto row = fpfh(plane.points, plane.normals, all, queries, 0.35f);
  for (int block = 0; block < 3; ++block) EXPECT_NEAR(row[block * 11 + 5], 1, 1e-5) << "all angles are zero";
}

TEST(Fpfh, DoesNotChangeWhenTheCloudIsMoved) {
  const Cloud cloud = bumps(600, 2);
  const Transform t = testing::pose_of({12, -7, 3}, {0.8, -1.9, 0.4});
  Cloud turned;
  turned.points = testing::moved(cloud.points, t);
  for (const auto& n : cloud.normals) turned.normals.push_back((t.linear() * n.cast<double>()).cast<float>());
  const auto all = first(600);
  const auto here = fpfh(cloud.points, cloud.normals, all, all, 0.25f),
             there = fpfh(turned.points, turned.normals, all, all, 0.25f);
  double difference = 0;
  for (std::size_t k = 0; k < here.size(); ++k) difference += static_cast<double>(std::abs(here[k] - there[k]));
  EXPECT_LT(difference / 600 / 3, 0.004);  // angles at the border of a bin may fall to either side
}

TEST(Fpfh, TellsABumpFromADent) {
  const Cloud cloud = bumps(800, 3);
  Cloud dents = cloud;  // the same surface seen from below
  for (auto& n : dents.normals) n = -n;
  const auto all = first(800);
  const auto above = fpfh(cloud.points, cloud.normals, all, all, 0.3f),
             below = fpfh(dents.points, dents.normals, all, all, 0.3f);
  double difference = 0;
  for (std::size_t k = 0; k < above.size(); ++k) difference += static_cast<double>(std::abs(above[k] - below[k]));
  EXPECT_GT(difference / 800 / 3, 0.1);
}

TEST(Fpfh, WithoutCarriersInReachTheRowIsZero) {
  const Points points{{0, 0, 0}, {10, 0, 0}, {10.1f, 0, 0}, {10, 0.1f, 0}}, normals(4, Eigen::Vector3f::UnitZ());
  const std::vector<std::uint32_t> carriers{1, 2, 3}, queries{0, 1};
  const auto rows = fpfh(points, normals, carriers, queries, 0.5f);
  for (std::uint32_t b = 0; b < kFpfhDimension; ++b) EXPECT_EQ(rows[b], 0);
  EXPECT_NEAR(block_sum(rows, 1, 0), 1, 1e-5);
  EXPECT_TRUE(fpfh(points, normals, carriers, {}, 0.5f).empty());
  for (const float v : fpfh(points, normals, {}, queries, 0.5f)) EXPECT_EQ(v, 0);
}

TEST(Fpfh, DuplicatesGiveNumbers) {
  const Points points(40, Eigen::Vector3f(1, 1, 1)), normals(40, Eigen::Vector3f::UnitZ());
  for (const float v : fpfh(points, normals, first(40), first(40), 0.5f)) EXPECT_TRUE(std::isfinite(v));
}

TEST(Fpfh, TheSameForAnyNumberOfThreads) {
  const Cloud cloud = bumps(700, 4);
  const auto all = first(700);
  const auto run = [&] { return fpfh(cloud.points, cloud.normals, all, all, 0.3f); };
  const auto one = testing::with_threads(1, run);
  EXPECT_EQ(testing::with_threads(2, run), one);
  EXPECT_EQ(testing::with_threads(7, run), one);
}

}  // namespace
}  // namespace isthmus
