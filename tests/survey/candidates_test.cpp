#include "survey/candidates.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>

#include "base/rng.h"
#include "regions/plan_likeness.h"
#include "regions/random_plan.h"
#include "survey/spanning_forest.h"

namespace isthmus {
namespace {

constexpr int kDimension = 33;
constexpr int kKeypoints = 120;

/// Scans along a street: each sees some places, every place has its own descriptors; neighbours share places. All of
/// them share half their keypoints with everybody (walls), which must not count.
struct Street {
  std::vector<std::vector<std::uint8_t>> descriptors;
  std::vector<CandidateInput> inputs;

  explicit Street(int num_scans) {
    descriptors.resize(static_cast<std::size_t>(num_scans));
    for (int i = 0; i < num_scans; ++i) {
      Rng noise(seed_of(1, fmt::format("{}", i)));
      for (int k = 0; k < kKeypoints; ++k) {
        const int place = k % 2 == 0 ? -1 : i * 30 + k / 2;  // the next scan shares half of the places
        Rng rng(seed_of(2, fmt::format("{}/{}", place, place < 0 ? k : 0)));
        std::vector<double> row(kDimension);
        double norm = 0;
        for (double& v : row) v = rng.uniform() * rng.uniform() + 0.002 * noise.uniform(), norm += v * v;
        for (const double v : row) descriptors[i].push_back(static_cast<std::uint8_t>(255 * v / std::sqrt(norm)));
      }
    }
    for (int i = 0; i < num_scans; ++i) {
      CandidateInput input;
      input.id = i;
      input.name = fmt::format("scan{}.ply", i);
      input.descriptors = {descriptors[i], kKeypoints, {}};
      inputs.push_back(input);
    }
  }
};

std::set<std::pair<int, int>> pairs_of(const CandidateGraph& graph) {
  std::set<std::pair<int, int>> pairs;
  for (const Candidate& c : graph.candidates)
    pairs.insert({std::min(c.source, c.target), std::max(c.source, c.target)});
  return pairs;
}

bool connected(const CandidateGraph& graph, int n) {
  survey::DisjointSets sets(n);
  int joins = 0;
  for (const Candidate& c : graph.candidates) joins += sets.join(c.source, c.target);
  return joins == n - 1;
}

// Sixty scans of one corridor: all have the same shapes, and only those of one room (three scans) at the same heights.
TEST(Candidates, AWordCountsAtItsOwnHeightAboveTheStation) {
  constexpr int kScans = 60, kRoomScans = 3;
  const Street street(1);
  std::vector<std::vector<float>> heights(kScans);
  std::vector<CandidateInput> inputs;
  for (int i = 0; i < kScans; ++i) {
    Rng rng(seed_of(5, fmt::format("{}", i / kRoomScans)));
    for (int k = 0; k < kKeypoints; ++k) heights[i].push_back(static_cast<float>(rng.uniform(-40, 40)));
    inputs.push_back({i, fmt::format("scan{}.ply", i), {street.descriptors[0], kKeypoints, heights[i]}, {}, false, {}});
  }
  const auto in_one_room = [&](std::size_t most) {
    const CandidateGraph graph = propose_candidates(inputs, {});
    std::size_t found = 0;
    for (std::size_t k = 0; k < most; ++k)
      found += graph.candidates[k].source / kRoomScans == graph.candidates[k].target / kRoomScans;
    return found;
  };
  constexpr std::size_t kTrue = kScans;  // three pairs a room
  EXPECT_EQ(in_one_room(kTrue), kTrue);
  // A scan that does not know its vertical is compared without heights, and changes nothing among the others.
  inputs.front().descriptors.heights_voxels = {};
  EXPECT_GE(in_one_room(kTrue), kTrue - 2);
  for (CandidateInput& input : inputs) input.descriptors.heights_voxels = {};
  EXPECT_LT(in_one_room(kTrue), kTrue / 2) << "without heights all are alike";
}

// Thirty stations along a street that words cannot tell apart; each sees a third of what the next sees.
std::vector<CandidateInput> stations_with_plans(const Street& street, bool knows_up) {
  constexpr int kScans = 30;
  constexpr float kStepM = 20, kRadiusM = 15;
  GroundPlan place;
  place.cell_m = 0.6f;
  for (int k = 0; k < kScans; ++k)
    for (const Column& c : testing::moved(testing::random_plan(150, 10, static_cast<std::uint64_t>(k)), 0,
                                          {kStepM * static_cast<float>(k), 0})
                               .columns)
      place.columns.push_back(c);
  std::vector<CandidateInput> inputs;
  Rng rng(6);
  for (int k = 0; k < kScans; ++k) {
    GroundPlan plan = testing::seen_within(place, {kStepM * static_cast<float>(k), 0}, kRadiusM);
    plan = testing::moved(plan, static_cast<float>(rng.uniform(-3, 3)), {1, 2}, static_cast<float>(rng.uniform(-1, 1)));
    if (!knows_up && k % 2 == 0) plan = upside_down(plan);
    inputs.push_back(
        {k, fmt::format("scan{:02}.ply", k), {street.descriptors[0], kKeypoints, {}}, std::move(plan), knows_up, {}});
  }
  return inputs;
}

TEST(Candidates, PlansFindTheNeighboursThatWordsCannotTellApart) {
  const Street street(1);
  for (const bool knows_up : {true, false}) {
    std::vector<CandidateInput> inputs = stations_with_plans(street, knows_up);
    const auto neighbours = [&] {
      int found = 0;
      const auto pairs = pairs_of(propose_candidates(inputs, {}));
      for (int i = 0; i + 1 < static_cast<int>(inputs.size()); ++i) found += pairs.contains({i, i + 1});
      return found;
    };
    EXPECT_GE(neighbours(), 28) << knows_up;
    inputs[7].plan.reset();
    EXPECT_GE(neighbours(), 26) << "a scan without a plan spoils nothing among the others";
    for (CandidateInput& input : inputs) input.plan.reset();
    EXPECT_LT(neighbours(), 10) << "all words are the same";
  }
}

TEST(Candidates, SmallSurveysTryEveryPairOnce) {
  const Street street(24);
  const CandidateGraph graph = propose_candidates(street.inputs, {});
  EXPECT_EQ(graph.candidates.size(), 276U);
  EXPECT_EQ(pairs_of(graph).size(), 276U);
  for (std::size_t i = 1; i < graph.candidates.size(); ++i)
    EXPECT_GE(graph.candidates[i - 1].score, graph.candidates[i].score);
}

TEST(Candidates, NeighboursShareRareWordsAndComeFirst) {
  const Street street(40);
  const CandidateGraph graph = propose_candidates(street.inputs, {});
  const auto pairs = pairs_of(graph);
  EXPECT_LE(graph.candidates.size(), 120U);  // half of the budget, rounded up
  EXPECT_TRUE(connected(graph, 40));
  int found = 0;
  for (int i = 0; i + 1 < 40; ++i) found += pairs.contains({i, i + 1});
  EXPECT_EQ(found, 39);
  for (int i = 0; i < 39; ++i) {
    const Candidate& c = graph.candidates[i];
    EXPECT_EQ(std::abs(c.source - c.target), 1) << c.source << ' ' << c.target << ' ' << c.score;
  }
}

TEST(Candidates, WhatIsNotTriedAtFirstIsHeldInReserveBestFirst) {
  const Street street(40);
  const CandidateGraph graph = propose_candidates(street.inputs, {});
  EXPECT_EQ(graph.candidates.size() + graph.reserve.size(), 780U);
  const auto chosen = pairs_of(graph);
  for (const Candidate& c : graph.reserve)
    EXPECT_FALSE(chosen.contains({std::min(c.source, c.target), std::max(c.source, c.target)}));
  for (std::size_t i = 1; i < graph.reserve.size(); ++i) EXPECT_GE(graph.reserve[i - 1].score, graph.reserve[i].score);
  EXPECT_TRUE(propose_candidates(std::span(street.inputs).first(20), {}).reserve.empty());
}

TEST(Candidates, GlancesAreCastAtTheMostAlikeAndDecide) {
  const Street street(40);
  CandidateOptions options;
  options.screened_per_scan = 4;
  int num_asked = 0;
  std::vector<std::pair<int, int>> glances;
  // A glance finds that 0 and 39 share much, and nothing elsewhere.
  const auto cast = [&](std::span<const std::pair<int, int>> pairs) {
    ++num_asked;
    glances.assign(pairs.begin(), pairs.end());
    std::vector<ScreenedPair> screened;
    for (const auto& [source, target] : pairs) screened.push_back({source, target, -0.2});
    screened.push_back({39, 0, 0.4});
    return screened;
  };
  const CandidateGraph graph = propose_candidates(street.inputs, options, cast);
  EXPECT_EQ(num_asked, 1);
  EXPECT_GE(glances.size(), 80U);
  EXPECT_LE(glances.size(), 160U);
  for (int i = 0; i + 1 < 40; ++i)
    EXPECT_EQ(std::ranges::count(glances, std::pair(std::max(i, i + 1), std::min(i, i + 1))) +
                  std::ranges::count(glances, std::pair(std::min(i, i + 1), std::max(i, i + 1))),
              1);
  EXPECT_EQ(graph.candidates.front().source, 39);
  EXPECT_EQ(graph.candidates.front().target, 0);
  EXPECT_LT(graph.candidates[1].score, 0.1 + 1e-9);
  options.only_groups = true;
  propose_candidates(street.inputs, options, cast);
  propose_candidates(std::span(street.inputs).first(20), {}, cast);
  EXPECT_EQ(num_asked, 1) << "nothing is asked where nothing depends on it";
}

TEST(Candidates, OrderOfTheFilesDoesNotMatter) {
  const Street street(40);
  CandidateOptions options;
  options.file_order_neighbours = 2;
  const CandidateGraph first = propose_candidates(street.inputs, options);
  std::vector<CandidateInput> shuffled = street.inputs;
  Rng rng(4);
  for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[rng.below(i)]);
  const CandidateGraph second = propose_candidates(shuffled, options);
  ASSERT_EQ(first.candidates.size(), second.candidates.size());
  for (std::size_t i = 0; i < first.candidates.size(); ++i) {
    EXPECT_EQ(first.candidates[i].source, second.candidates[i].source);
    EXPECT_EQ(first.candidates[i].target, second.candidates[i].target);
    EXPECT_EQ(first.candidates[i].score, second.candidates[i].score);
  }
}

TEST(Candidates, StayWithinHalfOfTheBudgetAtFirst) {
  const Street street(30);
  for (const int k : {1, 2, 3, 5, 10}) {
    CandidateOptions options;
    options.pairs_per_scan = k;
    EXPECT_LE(propose_candidates(street.inputs, options).candidates.size(), 30U * ((k + 1) / 2));
  }
}

TEST(Candidates, ScansWithoutDescriptorsAreAllInReserve) {
  std::vector<CandidateInput> inputs(30);
  for (int i = 0; i < 30; ++i) inputs[i].id = i, inputs[i].name = fmt::format("s{}", i);
  const CandidateGraph graph = propose_candidates(inputs, {});
  EXPECT_EQ(graph.candidates.size() + graph.reserve.size(), 435U);
}

TEST(Candidates, NoneForZeroAndOneScan) {
  EXPECT_TRUE(propose_candidates({}, {}).candidates.empty());
  const Street one(1);
  EXPECT_TRUE(propose_candidates(one.inputs, {}).candidates.empty());
}

TEST(Candidates, GroupsAreTriedWhateverTheBudget) {
  const Street street(40);
  CandidateOptions options;
  options.groups = {"scan0.ply scan39.ply", "scan3?.ply", "nowhere*.ply"};
  options.only_groups = true;
  const CandidateGraph graph = propose_candidates(street.inputs, options);
  EXPECT_EQ(graph.candidates.size(), 1U + 45U);
  EXPECT_TRUE(pairs_of(graph).contains({0, 39}));
  ASSERT_EQ(graph.warnings.size(), 1U);
  EXPECT_NE(graph.warnings[0].find("nowhere*.ply"), std::string::npos);
}

/// As the ids of a survey are given: the later name, byte by byte, is the source.
TEST(Candidates, LaterNameIsTheSource) {
  std::vector<CandidateInput> inputs(2);
  inputs[0].id = 5, inputs[0].name = "s2";
  inputs[1].id = 6, inputs[1].name = "s10";
  const CandidateGraph graph = propose_candidates(inputs, {});
  ASSERT_EQ(graph.candidates.size(), 1U);
  EXPECT_EQ(graph.candidates[0].source, 5);
}

TEST(Candidates, FileOrderIsNaturalOrder) {
  EXPECT_TRUE(natural_less("s2", "s10"));
  EXPECT_FALSE(natural_less("s10", "s2"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_TRUE(natural_less("s2", "s02b"));
  EXPECT_TRUE(natural_less("s02", "s2"));
  EXPECT_FALSE(natural_less("s2", "s2"));
  EXPECT_TRUE(natural_less("s2/a10", "s2/a11"));
}

TEST(Candidates, PriorPositionsRankNearPairsFirstAndLimitThem) {
  Street street(30);
  for (int i = 0; i < 30; ++i) street.inputs[i].prior_position = Eigen::Vector3d(10.0 * i, 0, 0);
  CandidateOptions options;
  options.max_distance_m = 25.0;
  const CandidateGraph graph = propose_candidates(street.inputs, options);
  for (const Candidate& c : graph.candidates) EXPECT_LE(std::abs(c.source - c.target), 2);
  EXPECT_TRUE(connected(graph, 30));
  street.inputs[29].prior_position = Eigen::Vector3d(9000, 0, 0);
  EXPECT_EQ(propose_candidates(street.inputs, options).warnings.size(), 1U);
}

}  // namespace
}  // namespace isthmus
