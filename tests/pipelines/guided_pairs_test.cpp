#include "pipelines/guided_pairs.h"

#include <gtest/gtest.h>

namespace isthmus::pipelines {
namespace {

/// Stations 10 m apart along a line; each sees a 30 m x 10 m floor around it.
struct Line {
  std::vector<ScanSummary> summaries;
  Solution solution;
  std::vector<OutlinedScan> scans;

  explicit Line(int count) : summaries(static_cast<std::size_t>(count)) {
    for (int i = 0; i < count; ++i) {
      ScanSummary& scan = summaries[static_cast<std::size_t>(i)];
      for (int x = -15; x <= 15; ++x) {
        for (int y = -5; y <= 5; ++y) scan.outline.emplace_back(x, y, 0);
      }
      scan.outline_cell_m = 1;
      PlacedScan placed;
      placed.id = i;
      placed.component_from_local.translation() = Eigen::Vector3d(10.0 * i, 0, 0);
      solution.scans.push_back(placed);
      scans.push_back({i, &scan, ""});
    }
  }
  void link(int source, int target, Verdict verdict) {
    SolvedLink solved;
    solved.link.source = source;
    solved.link.target = target;
    solved.link.result.verdict = verdict;
    solution.links.push_back(solved);
  }
};

TEST(GuidedPairs, are_those_that_overlap_and_have_no_accepted_link) {
  Line line(4);
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
  Line line(4);
  const auto pairs = propose_guided_pairs(line.solution, line.scans, 1);
  std::vector<std::pair<int, int>> found;
  for (const GuidedPair& pair : pairs) found.emplace_back(pair.source, pair.target);
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{{1, 0}, {2, 1}, {3, 2}}));
}

TEST(GuidedPairs, need_one_component) {
  Line line(2);
  line.solution.scans[1].component = 1;
  EXPECT_TRUE(propose_guided_pairs(line.solution, line.scans, 10).empty());
  EXPECT_TRUE(propose_guided_pairs({}, {}, 10).empty());
}

}  // namespace
}  // namespace isthmus::pipelines
