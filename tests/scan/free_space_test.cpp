#include "scan/free_space.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "scan/sample_points.h"

namespace isthmus {
namespace {

using testing::pose_of;
using testing::sampled;
using testing::scan_scene;

const float kInf = std::numeric_limits<float>::infinity();

FreeSpace empty_image(std::uint32_t size) { return {size, std::vector<float>(6 * size * size, kInf)}; }
float& cell(FreeSpace& image, std::uint32_t face, std::uint32_t row, std::uint32_t column) {
  return image.nearest_m[(face * image.size + row) * image.size + column];
}

TEST(CubeCell, EveryDirectionHasACellAndEveryCellADirection) {
  constexpr std::uint32_t kSize = 8;
  std::set<std::uint32_t> seen;
  for (const auto& d : testing::sphere_points(60000, Eigen::Vector3d::Zero(), 3, 1)) {
    const std::uint32_t c = cube_cell(d, kSize);
    ASSERT_LT(c, 6 * kSize * kSize);
    EXPECT_EQ(cube_cell(0.01f * d, kSize), c) << "the length of a direction does not matter";
    seen.insert(c);
  }
  EXPECT_EQ(seen.size(), 6u * kSize * kSize);
}

TEST(CubeCell, AxesEdgesAndCornersAreInRange) {
  for (const std::uint32_t size : {1u, 3u, 240u})
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Eigen::Vector3f d(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
          EXPECT_LT(cube_cell(d, size), 6 * size * size) << d.transpose();
        }
  std::set<std::uint32_t> faces;
  for (int a = 0; a < 3; ++a)
    for (const float sign : {-1.0f, 1.0f}) faces.insert(cube_cell(sign * Eigen::Vector3f::Unit(a), 9) / 81);
  EXPECT_EQ(faces.size(), 6u);
}

TEST(CubeCell, CellsAreSmallAnywhere) {
  constexpr std::uint32_t kSize = 90;  // about one degree
  std::vector<Eigen::Vector3f> first(6 * kSize * kSize, Eigen::Vector3f::Zero());
  for (const auto& p : testing::sphere_points(200000, Eigen::Vector3d::Zero(), 1, 2)) {
    Eigen::Vector3f& other = first[cube_cell(p, kSize)];
    if (other.isZero()) other = p;
    EXPECT_LT((p - other).norm(), 0.04f);
  }
}

TEST(FreeSpaceImage, DilationByHand) {
  FreeSpace raw = empty_image(5);
  cell(raw, 0, 2, 2) = 10;
  cell(raw, 0, 2, 3) = 7;
  cell(raw, 0, 1, 2) = 9;
  FreeSpace out = dilated_free_space(raw);
  EXPECT_EQ(cell(out, 0, 2, 2), 7);     // the minimum around
  EXPECT_EQ(cell(out, 0, 1, 3), 7);     // a hole between three returns is filled
  EXPECT_EQ(cell(out, 0, 3, 3), kInf);  // two neighbours do not fill a hole
  EXPECT_EQ(cell(out, 0, 0, 0), kInf);
  EXPECT_EQ(cell(out, 1, 2, 2), kInf);  // other faces know nothing of it
}

TEST(FreeSpaceImage, ASparseScanGetsCoarserCells) {
  FreeSpace full = empty_image(16), sparse = empty_image(16);
  for (std::size_t i = 0; i < full.nearest_m.size(); ++i) full.nearest_m[i] = static_cast<float>(5 + i % 7);
  for (std::uint32_t face = 0; face < 6; ++face)
    for (std::uint32_t row = 0; row < 16; row += 2)
      for (std::uint32_t column = 0; column < 16; column += 2)
        cell(sparse, face, row, column) = static_cast<float>(row + column + 1);
  EXPECT_EQ(at_scan_resolution(full).size, 16u);
  const FreeSpace coarse = at_scan_resolution(sparse);
  EXPECT_EQ(coarse.size, 8u);
  FreeSpace half = coarse;
  EXPECT_EQ(cell(half, 2, 3, 1), 6 + 2 + 1);
  EXPECT_GT(at_scan_resolution(empty_image(16)).size, 0u);
}

TEST(FreeSpaceImage, ARoomIsSeenThroughUpToItsWallsAndNotBeyond) {
  const SampledScan scan =
      sampled(scan_scene(testing::furnished_hall(4), pose_of({0.3, 0, 1.7}), {120000, 1e6, 0, 1}), 0.2);
  ASSERT_GT(scan.free_space.size, 0u);
  std::size_t free_before = 0, free_at = 0, free_behind = 0;
  for (const auto& p : scan.points) {
    const Eigen::Vector3f ray = p - scan.station;
    const float nearest = scan.free_space.nearest_m[cube_cell(ray, scan.free_space.size)];
    const auto is_free = [&](float range) { return std::isfinite(nearest) && range < nearest; };
    free_before += is_free(0.5f * ray.norm());
    free_at += is_free(1.001f * ray.norm() + 0.1f);
    free_behind += is_free(1.2f * ray.norm() + 0.2f);
  }
  EXPECT_GT(free_before, scan.points.size() * 85 / 100);  // at the outline of a box the box is nearer
  EXPECT_LT(free_at, scan.points.size() / 20);
  EXPECT_LT(free_behind, scan.points.size() / 50);
}

}  // namespace
}  // namespace isthmus
