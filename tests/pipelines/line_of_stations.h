// A made-up survey whose predicted overlaps are known by heart.
#pragma once

#include <fmt/format.h>

#include <vector>

#include "pipelines/guided_pairs.h"
#include "pipelines/part_joins.h"

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
  /// Moves the scans from `first` on into a component of their own, whose frame is that of scan `first`.
  void split(int first) {
    for (std::size_t i = static_cast<std::size_t>(first); i < solution.scans.size(); ++i) {
      solution.scans[i].component = 1;
      solution.scans[i].component_from_local.translation().x() -= 10.0 * first;
    }
  }
  /// An ambiguous link that would lay `source` where it stands on the line, or `off_m` away from there.
  Link& ambiguous(int source, int target, double probability, double off_m = 0) {
    Link& l = link(source, target, Verdict::ambiguous);
    l.result.target_from_source = Transform(Eigen::Translation3d(10.0 * (source - target) + off_m, 0, 0));
    l.result.probability = probability;
    return l;
  }
  Link& link(int source, int target, Verdict verdict) {
    SolvedLink solved;
    solved.link.source = source;
    solved.link.target = target;
    solved.link.result.verdict = verdict;
    solved.measured = verdict;
    solution.links.push_back(solved);
    return solution.links.back().link;
  }
};

inline std::vector<PartJoin> joins_of(const LineOfStations& line) {
  return possible_joins(line.solution, summaries_of(line.scans));
}

}  // namespace isthmus::pipelines
