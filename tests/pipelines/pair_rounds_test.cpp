#include "pipelines/pair_rounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
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
  EXPECT_EQ(pairs_of(rounds.next(solution, {}, {})), (Pairs{{3, 4}, {0, 3}, {0, 4}}));
  EXPECT_EQ(pairs_of(rounds.next(solution, {}, {})), (Pairs{{1, 3}, {2, 3}}));
  EXPECT_TRUE(rounds.next(solution, {}, {}).empty());
}

TEST(PairRounds, StopWhenEverythingHangsTogether) {
  CandidateGraph graph;
  graph.reserve = {candidate(1, 0, 0.5), candidate(2, 0, 0.4)};
  PairRounds rounds(graph, {}, 3);
  rounds.first();
  EXPECT_TRUE(rounds.next(placed({0, 0, 0}), {}, {}).empty());
}

TEST(PairRounds, KeepToTheBudgetsOfBothRounds) {
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
  std::size_t num_first = 0;
  std::map<int, int> late;
  for (auto wave = rounds.next(placed(alone), {}, {}); !wave.empty(); wave = rounds.next(placed(alone), {}, {})) {
    for (const auto& pair : pairs_of(wave)) EXPECT_TRUE(tried.insert(pair).second) << "tried twice";
    for (const PlannedPair& pair : wave) {
      num_first += pair.second_round ? 0 : 1;
      if (pair.second_round) ++late[pair.source], ++late[pair.target];
    }
  }
  EXPECT_EQ(num_first, 4U * kScans);
  EXPECT_GT(tried.size(), num_first) << "scans that are still alone go on";
  EXPECT_LE(tried.size() - num_first, 8U * kScans);
  // A scan asks for at most four more, and those of others that ask for it come on top.
  EXPECT_LE(tried.size() - num_first, 4U * kScans);
}

// 0-1-2 and 3-4-5 are parts. 3 -> 2 is ambiguous: if it is right, 4 and 1, for instance, overlap as well.
TEST(PairRounds, TryWhatWouldOverlapIfAnAmbiguousLinkBetweenPartsWereRight) {
  LineOfStations parts(6, 25);
  for (const auto& [s, t] :
       {std::pair{1, 0}, std::pair{2, 1}, std::pair{4, 3}, std::pair{5, 4}, std::pair{2, 0}, std::pair{5, 3}})
    parts.link(s, t, Verdict::accepted);
  parts.split(3);
  PairRounds rounds({}, {}, 6);
  EXPECT_TRUE(rounds.next(parts.solution, parts.scans, joins_of(parts)).empty());
  parts.ambiguous(3, 2, 0.4);
  const auto wave = rounds.next(parts.solution, parts.scans, joins_of(parts));
  const Pairs pairs = pairs_of(wave);
  EXPECT_TRUE(pairs.contains({1, 4}));
  EXPECT_FALSE(pairs.contains({2, 3})) << "it has had its try";
  for (const PlannedPair& pair : wave) {
    EXPECT_TRUE(pair.second_round);
    EXPECT_FALSE(pair.target_from_source) << "a witness is not told what to say";
    EXPECT_TRUE(pair.source >= 3 && pair.target < 3);
  }
  for (auto more = rounds.next(parts.solution, parts.scans, joins_of(parts)); !more.empty();
       more = rounds.next(parts.solution, parts.scans, joins_of(parts)))
    for (const auto& pair : pairs_of(more)) EXPECT_FALSE(pairs.contains(pair)) << "tried twice";
}

TEST(PairRounds, LookWhereThePosesPredictOverlapOnceAPair) {
  const LineOfStations line(3);
  PairRounds rounds({}, {}, 3);
  const auto wave = rounds.next(line.solution, line.scans, joins_of(line));
  EXPECT_EQ(pairs_of(wave), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  for (const PlannedPair& pair : wave) {
    ASSERT_TRUE(pair.target_from_source);
    EXPECT_NEAR(pair.target_from_source->translation().x(), 10.0 * (pair.source - pair.target), 1e-9);
    EXPECT_TRUE(pair.second_round);
  }
  EXPECT_TRUE(rounds.next(line.solution, line.scans, joins_of(line)).empty());
}

}  // namespace
}  // namespace isthmus::pipelines
