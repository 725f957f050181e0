// What holds for compact clusters only; the promises of every division are in divisions_test.cpp.
#include "regions/divide.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pairwise/synthetic_product.h"
#include "regions/partition.h"

namespace isthmus {
namespace {

using testing::expect_partition;

struct Scan {
  SampledScan sampled;
  FeatureCloud features;
};

Scan hall() {
  Scan scan;
  scan.sampled = testing::sampled(testing::scan_scene(testing::furnished_hall(1), testing::pose_of({0, 0, 1.7})), 0.2);
  scan.features = describe(scan.sampled, {});
  return scan;
}

TEST(DivideByClusters, MakesAsManyRegionsAsAskedFor) {
  const Scan scan = hall();
  for (const int per_region : {5, 40, 100000}) {
    const RegionMap map = divide(scan.sampled, scan.features, {"clusters", per_region});
    expect_partition(map, scan.features.keypoints.size());
    if (per_region == 100000) {
      EXPECT_EQ(map.regions.size(), 1u);
    } else {
      const double wanted = static_cast<double>(scan.features.keypoints.size()) / per_region;
      EXPECT_GT(static_cast<double>(map.regions.size()), 0.8 * wanted);
      EXPECT_LE(static_cast<double>(map.regions.size()), 1.01 * wanted + 1);
    }
  }
}

TEST(DivideByClusters, PutsKeypointsToTheNearestCentre) {
  const Scan scan = hall();
  const RegionMap map = divide(scan.sampled, scan.features, {});
  std::size_t nearest_is_own = 0;
  for (std::size_t k = 0; k < map.region_of_keypoint.size(); ++k) {
    const Eigen::Vector3f& p = scan.sampled.points[scan.features.keypoints[k]];
    const float own = (p - map.regions[map.region_of_keypoint[k]].centre).norm();
    nearest_is_own += std::all_of(map.regions.begin(), map.regions.end(),
                                  [&](const Region& r) { return (p - r.centre).norm() >= own * 0.999f; });
  }
  EXPECT_GT(nearest_is_own, map.region_of_keypoint.size() * 9 / 10);
}

}  // namespace
}  // namespace isthmus
