#include "pipelines/pair_rounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pipelines/line_of_stations.h"

namespace isthmus::pipelines {
namespace {

Candidate candidate(int source, int target, double score) { return {source, target, score, "likeness"}; }

/// Scans 0..n-1, each in the component given.
Solution placed(const std::vector<int>& component) {
  Solution solution;
  for (int id = 0; id < static_cast<int>(component.size()); ++id) {
    PlacedScan scan;
    scan.id = id;
    scan.component = component[static_cast<std::size_t>(id)];
    solution.scans.push_back(scan);
  }
  return solution;
}

using Pairs = std::set<std::pair<int, int>>;
Pairs pairs_of(const std::vector<PlannedPair>& planned) {
  Pairs pairs;
  for (const PlannedPair& p : planned) pairs.insert(std::minmax(p.source, p.target));
  return pairs;
}

TEST(PairRounds, BeginWithTheCandidates) {
  CandidateGraph graph;
  graph.candidates = {candidate(1, 0, 0.9), candidate(2, 1, 0.8)};
  PairRounds rounds(graph, {}, 3);
  EXPECT_EQ(pairs_of(rounds.first()), (Pairs{{0, 1}, {1, 2}}));
}

TEST(PairRounds, ScansOutsideTheLargestComponentAskForTheirMostPromisingPairs) {
  CandidateGraph graph;
  graph.candidates = {candidate(1, 0, 0.9)};
  graph.reserve = {candidate(2, 0, 0.5), candidate(4, 3, 0.45), candidate(3, 0, 0.4),
                   candidate(3, 1, 0.3), candidate(3, 2, 0.2),  candidate(4, 0, 0.1)};
  PairRounds rounds(graph, {}, 5);
  rounds.first();
  // 0, 1, 2 hang together, 3 and 4 stand alone: each asks for its best two; 2 - 0 is decided by the poses.
  const Solution solution = placed({0, 0, 0, 1, 2});
  EXPECT_EQ(pairs_of(rounds.next(solution, {})), (Pairs{{3, 4}, {0, 3}, {0, 4}}));
  EXPECT_EQ(pairs_of(rounds.next(solution, {})), (Pairs{{1, 3}, {2, 3}}));
  EXPECT_TRUE(rounds.next(solution, {}).empty());
}

TEST(PairRounds, StopWhenEverythingHangsTogether) {
  CandidateGraph graph;
  graph.reserve = {candidate(1, 0, 0.5), candidate(2, 0, 0.4)};
  PairRounds rounds(graph, {}, 3);
  rounds.first();
  EXPECT_TRUE(rounds.next(placed({0, 0, 0}), {}).empty());
}

TEST(PairRounds, KeepToTheBudgetOfTheFirstRound) {
  constexpr int kScans = 30;
  CandidateGraph graph;
  for (int a = 0; a < kScans; ++a)
    for (int b = 0; b < a; ++b) graph.reserve.push_back(candidate(a, b, 0.1));
  CandidateOptions options;
  options.pairs_per_scan = 4;
  PairRounds rounds(graph, options, kScans);
  rounds.first();
  std::vector<int> alone(kScans);
  for (int i = 0; i < kScans; ++i) alone[static_cast<std::size_t>(i)] = i;
  Pairs tried;
  for (auto wave = rounds.next(placed(alone), {}); !wave.empty(); wave = rounds.next(placed(alone), {})) {
    for (const auto& pair : pairs_of(wave)) EXPECT_TRUE(tried.insert(pair).second) << "tried twice";
  }
  EXPECT_EQ(tried.size(), 4U * kScans);
}

TEST(PairRounds, LookWhereThePosesPredictOverlapOnceAPair) {
  const LineOfStations line(3);
  PairRounds rounds({}, {}, 3);
  const auto wave = rounds.next(line.solution, line.scans);
  EXPECT_EQ(pairs_of(wave), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  for (const PlannedPair& pair : wave) {
    ASSERT_TRUE(pair.target_from_source);
    EXPECT_NEAR(pair.target_from_source->translation().x(), 10.0 * (pair.source - pair.target), 1e-9);
    EXPECT_EQ(pair.why, "predicted");
  }
  EXPECT_TRUE(rounds.next(line.solution, line.scans).empty());
}

}  // namespace
}  // namespace isthmus::pipelines
