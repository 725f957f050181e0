#include "pipelines/intensity_sampler.h"

#include <gtest/gtest.h>

namespace isthmus::pipelines {
namespace {

SampledScan two_points() {
  SampledScan scan;
  scan.voxel_m = 2;
  scan.points = {{0.5f, 0.5f, 0.5f}, {-0.5f, 0.5f, 0.5f}};
  return scan;
}

// Nine points in each of two cells of 1 m: every third counts.
PointChunk eighteen_points() {
  PointChunk chunk;
  for (int k = 0; k < 18; ++k) {
    chunk.points.emplace_back(k < 9 ? 0.3f : -0.3f, 0.2f, 0.1f);
    chunk.intensity.push_back(static_cast<float>(k));
  }
  return chunk;
}

TEST(IntensitySampler, IsTheMeanOfEveryThirdPointOfACell) {
  IntensitySampler sampler(2);
  sampler.add(eighteen_points());
  EXPECT_EQ(sampler.of(two_points()), (std::vector<float>{3, 12}));  // 0 3 6, 9 12 15
}

TEST(IntensitySampler, DoesNotDependOnTheChunks) {
  const PointChunk all = eighteen_points();
  IntensitySampler sampler(2);
  for (std::size_t k = 0; k < all.points.size(); ++k) {
    PointChunk one;
    one.points = {all.points[k]};
    one.intensity = {all.intensity[k]};
    sampler.add(one);
  }
  EXPECT_EQ(sampler.of(two_points()), (std::vector<float>{3, 12}));
}

TEST(IntensitySampler, TheFineLevelComesFirstAndPlacesWithoutPointsGetTheMean) {
  IntensitySampler sampler(2);
  sampler.add(eighteen_points());
  SampledScan scan = two_points();
  scan.fine.points = {{0.5f, 0.5f, 0.5f}, {50, 0, 0}, {-0.5f, 0.5f, 0.5f}};
  EXPECT_EQ(sampler.of(scan), (std::vector<float>{3, 7.5f, 12}));
}

TEST(IntensitySampler, IsEmptyWhereOneChunkHasNone) {
  IntensitySampler sampler(2);
  EXPECT_TRUE(sampler.of(two_points()).empty());
  PointChunk chunk = eighteen_points();
  sampler.add(chunk);
  chunk.intensity.clear();
  sampler.add(chunk);
  EXPECT_TRUE(sampler.of(two_points()).empty());
}

}  // namespace
}  // namespace isthmus::pipelines
