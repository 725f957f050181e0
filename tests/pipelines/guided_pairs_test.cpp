#include "pipelines/guided_pairs.h"

#include <gtest/gtest.h>

#include "pipelines/line_of_stations.h"

namespace isthmus::pipelines {
namespace {

TEST(GuidedPairs, are_those_that_overlap_and_have_no_accepted_link) {
  LineOfStations line(4);
  line.link(1, 0, Verdict::accepted);
  line.link(2, 0, Verdict::rejected);
  const auto pairs = propose_guided_pairs(line.solution, line.scans, 10);
  std::vector<std::pair<int, int>> found;
  for (const GuidedPair& pair : pairs) found.emplace_back(pair.source, pair.target);
  EXPECT_EQ(found,
            (std::vector<std::pair<int, int>>{{2, 0}, {2, 1}, {3, 1}, {3, 2}}));  // 3 and 0 see none of each other
  EXPECT_NEAR(pairs[0].target_from_source.translation().x(), 20, 1e-12);
  EXPECT_NEAR(pairs[0].predicted_overlap, 12.0 / 31.0, 0.04);
}

TEST(GuidedPairs, keep_the_best_of_each_scan) {
  LineOfStations line(4);
  const auto pairs = propose_guided_pairs(line.solution, line.scans, 1);
  std::vector<std::pair<int, int>> found;
  for (const GuidedPair& pair : pairs) found.emplace_back(pair.source, pair.target);
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{{1, 0}, {2, 1}, {3, 2}}));
}

TEST(GuidedPairs, need_one_component) {
  LineOfStations line(2);
  line.solution.scans[1].component = 1;
  EXPECT_TRUE(propose_guided_pairs(line.solution, line.scans, 10).empty());
  EXPECT_TRUE(propose_guided_pairs({}, {}, 10).empty());
}

}  // namespace
}  // namespace isthmus::pipelines
