// A made-up survey whose predicted overlaps are known by heart.
#pragma once

#include <fmt/format.h>

#include <vector>

#include "pipelines/guided_pairs.h"

namespace isthmus::pipelines {

/// Stations 10 m apart along x, in one component; each sees a floor 10 m wide that reaches `reach_m` either way.
struct LineOfStations {
  std::vector<ScanSummary> summaries;
  Solution solution;
  std::vector<OutlinedScan> scans;

  explicit LineOfStations(int count, int reach_m = 15) : summaries(static_cast<std::size_t>(count)) {
    for (int i = 0; i < count; ++i) {
      ScanSummary& scan = summaries[static_cast<std::size_t>(i)];
      for (int x = -reach_m; x <= reach_m; ++x)
        for (int y = -5; y <= 5; ++y) scan.outline.emplace_back(x, y, 0);
      scan.outline_cell_m = 1;
      PlacedScan placed;
      placed.id = i;
      placed.component_from_local.translation() = Eigen::Vector3d(10.0 * i, 0, 0);
      solution.scans.push_back(placed);
      scans.push_back({i, &scan, fmt::format("s{}", i)});
    }
  }
  Link& link(int source, int target, Verdict verdict, bool in_loop = false) {
    SolvedLink solved;
    solved.link.source = source;
    solved.link.target = target;
    solved.link.result.verdict = verdict;
    solved.in_loop = in_loop;
    solution.links.push_back(solved);
    return solution.links.back().link;
  }
};

}  // namespace isthmus::pipelines
