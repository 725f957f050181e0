// What every division promises, and how alike two divisions are.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "regions/region_map.h"

namespace isthmus::testing {

inline void expect_partition(const RegionMap& map, std::size_t num_keypoints) {
  ASSERT_EQ(map.region_of_keypoint.size(), num_keypoints);
  std::vector<int> members(num_keypoints, 0);
  for (std::uint32_t r = 0; r < map.regions.size(); ++r) {
    EXPECT_FALSE(map.regions[r].keypoints.empty());
    EXPECT_TRUE(std::is_sorted(map.regions[r].keypoints.begin(), map.regions[r].keypoints.end()));
    for (const std::uint32_t k : map.regions[r].keypoints) {
      ASSERT_LT(k, num_keypoints);
      ++members[k];
      EXPECT_EQ(map.region_of_keypoint[k], r);
    }
  }
  EXPECT_EQ(std::count(members.begin(), members.end(), 1), static_cast<std::ptrdiff_t>(num_keypoints));
}

/// Share of the keypoints that lie in the region of `b` that shares most with their region of `a`.
inline double agreement(const RegionMap& a, const RegionMap& b) {
  std::size_t agreeing = 0;
  for (const Region& region : a.regions) {
    std::map<std::uint32_t, std::size_t> shared;
    for (const std::uint32_t k : region.keypoints) ++shared[b.region_of_keypoint[k]];
    std::size_t most = 0;
    for (const auto& [other, count] : shared) most = std::max(most, count);
    agreeing += most;
  }
  return static_cast<double>(agreeing) / static_cast<double>(std::max<std::size_t>(1, a.region_of_keypoint.size()));
}

}  // namespace isthmus::testing
