#include "survey/pose_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "survey/synthetic_survey.h"

namespace isthmus::testing {
namespace {

std::set<std::pair<int, int>> accepted(const Solution& solution) {
  std::set<std::pair<int, int>> out;
  for (const SolvedLink& l : solution.links)
    if (l.link.result.verdict == Verdict::accepted) out.insert({l.link.source, l.link.target});
  return out;
}

TEST(Solve, NothingGivesNothing) {
  const Solution solution = solve({kVoxel, {}, {}}, {});
  EXPECT_TRUE(solution.components.empty());
  EXPECT_TRUE(solution.scans.empty());
  EXPECT_TRUE(solution.links.empty());
}

TEST(Solve, ScansWithoutLinksStandAlone) {
  const World world(3);
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(solution.components.size(), 3U);
  EXPECT_EQ(solution.components[0].scans, std::vector<int>{0});
  EXPECT_EQ(solution.components[2].anchor, 2);
  EXPECT_TRUE(solution.scans[1].component_from_local.isApprox(Transform::Identity()));
  EXPECT_FALSE(predicted_target_from_source(solution, 0, 1));
}

TEST(Solve, ChainFollowsItsLinks) {
  World world(5);
  for (int i = 0; i + 1 < 5; ++i) world.exact(i, i + 1);
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(solution.components.size(), 1U);
  EXPECT_EQ(solution.components[0].anchor, 1);  // two links, and the smallest id that has two
  EXPECT_LT(worst_error_m(world, solution), 1e-9);
  for (const SolvedLink& l : solution.links) {
    EXPECT_FALSE(l.in_loop);
    ASSERT_TRUE(l.after);
    EXPECT_LT(l.after->chi2, 1e-9);
  }
}

TEST(Solve, LoopSpreadsItsError) {
  World world(6);
  for (int i = 0; i < 6; ++i) world.exact(i, (i + 1) % 6);
  // One link of the ring is off by half a voxel: too little to be wrong, so all six share it.
  world.graph.links[3].result.target_from_source->translation().x() += 0.5 * kVoxel;
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(accepted(solution).size(), 6U);
  EXPECT_LT(worst_error_m(world, solution), 0.5 * kVoxel);
  double before = 0, after = 0;
  for (const SolvedLink& l : solution.links) {
    ASSERT_TRUE(l.before && l.after);
    EXPECT_TRUE(l.in_loop);
    EXPECT_GT(l.after->chi2, 1e-6);  // every link takes its share
    before += l.before->chi2, after += l.after->chi2;
  }
  EXPECT_LT(after, before / 6);
}

TEST(Solve, WrongLinkInALoopIsRejectedWithItsError) {
  World world(5);
  for (int i = 0; i < 5; ++i) world.right(i, (i + 1) % 5);
  world.right(0, 2), world.right(1, 3), world.right(2, 4);
  world.shifted(1, 4, 3.25, 0.999);  // more certain of itself than any other
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 1U);
  const SolvedLink* link = find_link(solution, 1, 4);
  ASSERT_NE(link, nullptr);
  EXPECT_EQ(link->link.result.verdict, Verdict::rejected);
  EXPECT_EQ(link->measured, Verdict::accepted);
  EXPECT_NE(link->link.result.reason.find("disagrees with the loop s1 - "), std::string::npos)
      << link->link.result.reason;
  EXPECT_NE(link->link.result.reason.find("3.2"), std::string::npos) << link->link.result.reason;
  EXPECT_EQ(accepted(solution).size(), 8U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

TEST(Solve, WrongBridgeCannotBeJudgedAndStays) {
  World world(6);
  world.right(0, 1), world.right(1, 2), world.right(0, 2);
  world.right(3, 4), world.right(4, 5), world.right(3, 5);
  world.wrong(2, 3);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 1U);
  const SolvedLink* bridge = find_link(solution, 2, 3);
  ASSERT_NE(bridge, nullptr);
  EXPECT_EQ(bridge->link.result.verdict, Verdict::accepted);
  EXPECT_FALSE(bridge->in_loop);
  EXPECT_TRUE(find_link(solution, 0, 1)->in_loop);
}

TEST(Solve, TriangleOfUnequalLinksLosesTheDoubtfulOne) {
  World world(3);
  world.right(0, 1, 0.99), world.right(1, 2, 0.99), world.wrong(0, 2, 0.6);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(accepted(solution), (std::set<std::pair<int, int>>{{0, 1}, {1, 2}}));
}

TEST(Solve, TriangleOfEqualLinksIsUndecided) {
  World world(3);
  world.right(0, 1, 0.9), world.right(1, 2, 0.9), world.wrong(0, 2, 0.9);
  const Solution solution = solve(world.graph, {});
  EXPECT_TRUE(accepted(solution).empty());
  EXPECT_FALSE(solution.warnings.empty());
  EXPECT_NE(find_link(solution, 0, 2)->link.result.reason.find("nothing else tells"), std::string::npos);
}

TEST(Solve, HalfOfTheLinksWrong) {
  for (const std::uint64_t seed : {1ULL, 2ULL, 3ULL, 4ULL, 5ULL}) {
    World world(12, seed);
    std::set<std::pair<int, int>> right;
    for (int i = 0; i < 12; ++i) {
      world.right(i, (i + 1) % 12, 0.9), right.insert({i, (i + 1) % 12});
      world.right(i, (i + 2) % 12, 0.9), right.insert({i, (i + 2) % 12});
      world.wrong(i, (i + 5) % 12, 0.95);
      world.wrong(i, (i + 4) % 12, 0.95);
    }
    const Solution solution = solve(world.graph, {});
    EXPECT_EQ(accepted(solution), right) << "seed " << seed;
    EXPECT_LT(worst_error_m(world, solution), kVoxel) << "seed " << seed;
  }
}

TEST(Solve, GroupOfEquallyShiftedLinksLosesToTheMajority) {
  World world(8);
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) world.right(i, j), world.right(i + 4, j + 4);
  world.right(0, 4, 0.9), world.right(1, 5, 0.9), world.right(2, 6, 0.9);
  // Two links agree with each other on the same wrong joint transform.
  Transform wrong_joint = random_pose(world.rng, 10.0);
  world.add(3, 7, world.world_from_local[7].inverse() * wrong_joint * world.world_from_local[3], 0.97);
  world.add(0, 5, world.world_from_local[5].inverse() * wrong_joint * world.world_from_local[0], 0.97);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(find_link(solution, 3, 7)->link.result.verdict, Verdict::rejected);
  EXPECT_EQ(find_link(solution, 0, 5)->link.result.verdict, Verdict::rejected);
  EXPECT_EQ(accepted(solution).size(), 15U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

TEST(Solve, ComponentsAreNumberedBySizeThenId) {
  World world(9);
  world.right(7, 8);
  world.right(2, 3);
  world.right(4, 5), world.right(5, 6);
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(solution.components.size(), 5U);
  EXPECT_EQ(solution.components[0].scans, (std::vector<int>{4, 5, 6}));
  EXPECT_EQ(solution.components[0].anchor, 5);
  EXPECT_EQ(solution.components[1].scans, (std::vector<int>{2, 3}));
  EXPECT_EQ(solution.components[2].scans, (std::vector<int>{7, 8}));
  EXPECT_EQ(solution.components[3].scans, (std::vector<int>{0}));
  EXPECT_EQ(solution.find(8)->component, 2);
}

TEST(Solve, GuidedLinkProvesNothing) {
  World world(3);
  world.wrong(0, 1, 0.9), world.right(1, 2, 0.9);
  // Told to look where the wrong link points, the second round finds "agreement" and outvotes the direct link by
  // number.
  const Transform told =
      *world.graph.links[1].result.target_from_source * *world.graph.links[0].result.target_from_source;
  world.add(0, 2, told, 0.9).guided = true;
  world.right(0, 2, 0.99);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(find_link(solution, 0, 1)->link.result.verdict, Verdict::rejected);
}

TEST(Solve, UnusableLinksFailWithAReason) {
  World world(3);
  world.right(0, 1);
  world.right(1, 2).result.target_from_source->translation().x() = std::nan("");
  world.add(0, 9, Transform::Identity());  // there is no such scan
  world.right(2, 2);
  world.right(0, 2).result.target_from_source.reset();
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(solution.links.size(), 5U);
  int failed = 0;
  for (const SolvedLink& l : solution.links) {
    if (l.link.result.verdict != Verdict::failed) continue;
    ++failed;
    EXPECT_NE(l.link.result.reason.find("cannot be used"), std::string::npos);
  }
  EXPECT_EQ(failed, 4);
  EXPECT_EQ(solution.components.size(), 2U);
}

TEST(Solve, SlidingDirectionIsNotHeldAgainstALink) {
  World world(3);
  world.right(0, 1), world.right(1, 2);
  Link& sliding = world.right(0, 2);
  sliding.result.information.row(0).setZero();  // says nothing about x of the source's frame
  sliding.result.information.col(0).setZero();
  sliding.result.target_from_source = *sliding.result.target_from_source * Eigen::Translation3d(2.0, 0, 0);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(accepted(solution).size(), 3U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

TEST(Solve, AmbiguousLinkThatTheLoopConfirmsIsPromoted) {
  World world(4);
  world.right(0, 1), world.right(1, 2), world.right(2, 3);
  world.right(0, 3, 0.4, Verdict::ambiguous);
  world.shifted(0, 2, 1.5, 0.4, Verdict::ambiguous);
  const Solution solution = solve(world.graph, {});
  const SolvedLink* good = find_link(solution, 0, 3);
  EXPECT_EQ(good->link.result.verdict, Verdict::accepted);
  EXPECT_EQ(good->measured, Verdict::ambiguous);
  EXPECT_NE(good->link.result.reason.find("agrees with the loop"), std::string::npos);
  EXPECT_EQ(find_link(solution, 0, 2)->link.result.verdict, Verdict::ambiguous);
}

TEST(Solve, AnUnlikelyLinkMustAgreeTwiceAsClosely) {
  for (const auto& [probability, expected] : {std::pair{0.06, Verdict::ambiguous}, std::pair{0.5, Verdict::accepted}}) {
    World world(4);
    for (int i = 0; i < 3; ++i) world.exact(i, i + 1), world.exact(i, (i + 2) % 4);
    world.add(3, 0, world.truth(3, 0) * Transform(Eigen::Translation3d(1.5 * kVoxel, 0, 0)), probability,
              Verdict::ambiguous);
    EXPECT_EQ(find_link(solve(world.graph, {}), 3, 0)->link.result.verdict, expected) << probability;
  }
}

TEST(Solve, TwoAmbiguousLinksThatAgreeJoinParts) {
  World world(4);
  world.right(0, 1), world.right(2, 3);
  world.right(0, 2, 0.5, Verdict::ambiguous);
  Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 2U);  // one alone is not enough
  world.right(1, 3, 0.5, Verdict::ambiguous);
  solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 1U);
  EXPECT_EQ(accepted(solution).size(), 4U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
  SolveOptions careful;
  careful.promote_ambiguous = false;
  EXPECT_EQ(solve(world.graph, careful).components.size(), 2U);
}

TEST(Solve, RefutedLinksAreRejectedAndJoinNothing) {
  World world(2);
  world.right(0, 1).refuted = "the scans around it say no";
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 2U);
  EXPECT_EQ(find_link(solution, 0, 1)->link.result.verdict, Verdict::rejected);
  EXPECT_EQ(find_link(solution, 0, 1)->measured, Verdict::accepted);
  EXPECT_EQ(find_link(solution, 0, 1)->link.result.reason, "the scans around it say no");
}

TEST(Solve, OfALinkThatIsRefutedAndTakenOutTheHandIsNamed) {
  World world(2);
  Link& link = world.right(0, 1);
  link.refuted = "the scans around it say no";
  link.by_hand = ByHand::taken_out;
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(find_link(solution, 0, 1)->link.result.verdict, Verdict::rejected);
  EXPECT_NE(find_link(solution, 0, 1)->link.result.reason.find("taken out by hand"), std::string::npos);
}

// Equal rooms, a whole number of rooms apart: links that are wrong by the same shift agree, but the scans stand in each
// other's seen-through space.
TEST(Solve, LinksThatFreeSpaceForbidsConfirmNobody) {
  World world(4);
  world.right(0, 1), world.right(2, 3);
  for (const auto& [i, j] : {std::pair{0, 2}, std::pair{1, 3}}) {
    Link& link = world.right(i, j, 0.5, Verdict::ambiguous);
    link.result.evidence = {{"support", 0.5}, {"contradiction", 0.06}};
  }
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2U);
  for (const std::size_t k : {2u, 3u}) world.graph.links[k].result.overlap = 0.5;
  world.graph.links[2].result.evidence =
      world.graph.links[3].result.evidence = {{"support", 0.5}, {"contradiction", 0.02}};
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2U) << "4 % where half is shared";
  world.graph.links[2].result.evidence =
      world.graph.links[3].result.evidence = {{"support", 0.5}, {"contradiction", 0.005}};
  EXPECT_EQ(solve(world.graph, {}).components.size(), 1U);
}

TEST(Solve, TwoAmbiguousLinksThatDisagreeJoinNothing) {
  World world(4);
  world.right(0, 1), world.right(2, 3);
  world.right(0, 2, 0.5, Verdict::ambiguous);
  world.shifted(1, 3, 1.0, 0.5, Verdict::ambiguous);
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2U);
}

TEST(Solve, RivalPairsOfAmbiguousLinksJoinNothing) {
  World world(6);
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) world.right(i, j), world.right(i + 3, j + 3);
  world.right(0, 3, 0.5, Verdict::ambiguous), world.right(1, 4, 0.5, Verdict::ambiguous);
  const Transform joint = random_pose(world.rng, 5.0);
  for (const auto& [i, j] : {std::pair{2, 5}, std::pair{0, 4}})
    world.add(i, j, world.world_from_local[j].inverse() * joint * world.world_from_local[i], 0.5, Verdict::ambiguous);
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2U);
}

TEST(Solve, AmbiguousTriangleOfThreeScansCloses) {
  World world(3);
  world.right(0, 1, 0.7, Verdict::ambiguous), world.right(1, 2, 0.7, Verdict::ambiguous);
  world.right(0, 2, 0.7, Verdict::ambiguous);
  EXPECT_EQ(solve(world.graph, {}).components.size(), 1U);
  world.graph.links[2].result.target_from_source->translation().y() += 1.0;
  EXPECT_EQ(solve(world.graph, {}).components.size(), 3U);
}

/// A link that the pair stage accepted is a bridge to the accepted ones alone, but the ambiguous ones know better.
TEST(Solve, WrongBridgeIsRejectedByAmbiguousLinksThatAgree) {
  World world(6);
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 3; ++j) world.right(i, j), world.right(i + 3, j + 3);
  world.wrong(2, 3, 0.96);
  world.right(0, 3, 0.7, Verdict::ambiguous), world.right(1, 4, 0.5, Verdict::ambiguous);
  world.wrong(0, 5, 0.6, Verdict::ambiguous), world.wrong(1, 5, 0.6, Verdict::ambiguous);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(find_link(solution, 2, 3)->link.result.verdict, Verdict::rejected);
  EXPECT_EQ(find_link(solution, 0, 3)->link.result.verdict, Verdict::accepted);
  EXPECT_EQ(find_link(solution, 1, 4)->link.result.verdict, Verdict::accepted);
  EXPECT_EQ(find_link(solution, 0, 5)->link.result.verdict, Verdict::ambiguous);
  EXPECT_EQ(solution.components.size(), 1U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

/// Links between two parts may agree only by way of a scan that is itself held by ambiguous links.
TEST(Solve, AgreementIsFoundThroughAThirdScan) {
  World world(5);
  world.right(0, 1), world.right(2, 3);
  world.right(0, 4, 0.7, Verdict::ambiguous), world.right(2, 4, 0.7, Verdict::ambiguous);
  world.right(1, 3, 0.7, Verdict::ambiguous);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.size(), 1U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

TEST(Solve, ChainOfAmbiguousLinksIsNotBelieved) {
  World world(4);
  for (int i = 0; i + 1 < 4; ++i) world.right(i, i + 1, 0.9, Verdict::ambiguous);
  EXPECT_EQ(solve(world.graph, {}).components.size(), 4U);
}

TEST(Solve, HundredScansWithAsManyWrongLinksAreSolvedQuickly) {
  World world(100, 13);
  for (int i = 0; i < 100; ++i) {
    for (const int step : {1, 2, 11})
      world.right(i, (i + step) % 100, 0.9, step == 2 ? Verdict::ambiguous : Verdict::accepted);
    world.wrong(i, (i + 37) % 100, 0.96);
    world.wrong(i, (i + 50 + i % 7) % 100, 0.6, Verdict::ambiguous);
  }
  const Solution solution = solve(world.graph, {});
  // A third of the accepted links is wrong, so none is believed on its word; a few right ones find no second witness.
  EXPECT_GE(accepted(solution).size(), 290U);
  EXPECT_LE(accepted(solution).size(), 300U);
  EXPECT_LT(worst_error_m(world, solution), kVoxel);
}

TEST(Solve, OrderOfScansAndLinksDoesNotShow) {
  World world(10, 3);
  for (int i = 0; i < 10; ++i) world.right(i, (i + 1) % 10), world.right(i, (i + 3) % 10, 0.5, Verdict::ambiguous);
  world.wrong(0, 5), world.wrong(2, 7);
  const Solution first = solve(world.graph, {});
  Rng rng(99);
  for (int trial = 0; trial < 3; ++trial) {
    PoseGraph shuffled = world.graph;
    for (std::size_t i = shuffled.links.size(); i > 1; --i)
      std::swap(shuffled.links[i - 1], shuffled.links[rng.below(i)]);
    for (std::size_t i = shuffled.scans.size(); i > 1; --i)
      std::swap(shuffled.scans[i - 1], shuffled.scans[rng.below(i)]);
    const Solution second = solve(shuffled, {});
    ASSERT_EQ(second.scans.size(), first.scans.size());
    for (std::size_t i = 0; i < first.scans.size(); ++i)
      EXPECT_EQ(first.scans[i].component_from_local.matrix(), second.scans[i].component_from_local.matrix());
    ASSERT_EQ(second.links.size(), first.links.size());
    for (std::size_t i = 0; i < first.links.size(); ++i) {
      EXPECT_EQ(first.links[i].link.source, second.links[i].link.source);
      EXPECT_EQ(first.links[i].link.result.reason, second.links[i].link.result.reason);
    }
  }
}

/// Moving the frames of the scans about changes the numbers, not the survey.
TEST(Solve, FramesOfTheScansDoNotMatter) {
  World world(8, 5);
  for (int i = 0; i < 8; ++i) world.right(i, (i + 1) % 8), world.right(i, (i + 2) % 8);
  world.wrong(0, 4);
  const Solution first = solve(world.graph, {});
  std::vector<Transform> new_from_old;
  Rng rng(5);
  PoseGraph moved = world.graph;
  for (GraphScan& scan : moved.scans) {
    new_from_old.push_back(random_pose(rng, 1000.0));
    scan.centre = new_from_old.back() * scan.centre;
  }
  for (Link& link : moved.links) {
    const Transform& source = new_from_old[link.source];
    *link.result.target_from_source =
        orthonormalised(new_from_old[link.target] * *link.result.target_from_source * source.inverse());
    // d_new = Ad(new_from_old) d_old, in the source's frame
    Matrix6d ad = Matrix6d::Zero();
    const Eigen::Vector3d t = source.translation();
    Eigen::Matrix3d cross;
    cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
    ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = source.linear();
    ad.topRightCorner<3, 3>() = cross * source.linear();
    const Matrix6d inverse = ad.inverse();
    link.result.information = inverse.transpose() * link.result.information * inverse;
  }
  const Solution second = solve(moved, {});
  EXPECT_EQ(accepted(first), accepted(second));
  for (std::size_t i = 0; i < first.scans.size(); ++i) {
    const int anchor = first.components[0].anchor;
    const Transform expected = new_from_old[anchor] * first.scans[i].component_from_local * new_from_old[i].inverse();
    EXPECT_LT((expected.matrix() - second.scans[i].component_from_local.matrix()).norm(), 1e-5);
    EXPECT_NEAR(first.scans[i].sigma_m.value_or(0), second.scans[i].sigma_m.value_or(0), 1e-6);
  }
}

TEST(Solve, AConfirmedAmbiguousLinkJoinsAndARefutedOneDoesNot) {
  World world(3);
  world.exact(1, 0);
  Link& join = world.exact(2, 1, 0.4, Verdict::ambiguous);
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2u);
  join.confirmed = "three pairs meet", join.confirmed_probability = 0.99;
  const Solution joined = solve(world.graph, {});
  EXPECT_EQ(joined.components.size(), 1u);
  const SolvedLink* link = find_link(joined, 2, 1);
  EXPECT_EQ(link->measured, Verdict::ambiguous);
  EXPECT_EQ(link->link.result.reason, "three pairs meet (by itself ambiguous: as made)");
  EXPECT_EQ(link->probability, 0.99);
  join.refuted = "it stands in the air";
  EXPECT_EQ(solve(world.graph, {}).components.size(), 2u);
}

// The same accepted link, where most pairs that were tried fit and where hardly any did.
TEST(Solve, WhereFewPairsFitALinkWithoutALoopNeedsMore) {
  const auto verdicts = [](int num_misses, ByHand by_hand = ByHand::nothing, bool closed = false) {
    World world(60);
    for (int i = 0; i < 9; ++i) world.exact(i, i + 1, 0.9999);
    world.exact(10, 0, 0.975).by_hand = by_hand;
    if (closed) world.exact(10, 5, 0.975);
    for (int i = 0; i < num_misses; ++i) world.wrong(11 + i % 49, i % 10, 0.01, Verdict::rejected);
    return solve(world.graph, {});
  };
  const auto doubtful = [](const Solution& solution) { return find_link(solution, 10, 0); };
  const Solution few_misses = verdicts(5), many_misses = verdicts(100);
  EXPECT_EQ(doubtful(few_misses)->link.result.verdict, Verdict::accepted);
  EXPECT_EQ(few_misses.components.front().scans.size(), 11u);
  EXPECT_EQ(doubtful(many_misses)->link.result.verdict, Verdict::ambiguous);
  EXPECT_NE(doubtful(many_misses)->link.result.reason.find("only 12 % of the pairs tried fit"), std::string::npos)
      << doubtful(many_misses)->link.result.reason;
  EXPECT_LT(doubtful(many_misses)->probability, 0.9);
  EXPECT_EQ(many_misses.components.front().scans.size(), 10u) << "the sure ones stay";
  EXPECT_EQ(doubtful(verdicts(100, ByHand::added))->link.result.verdict, Verdict::accepted);
  EXPECT_EQ(doubtful(verdicts(100, ByHand::nothing, true))->link.result.verdict, Verdict::accepted) << "a loop";
}

TEST(Solve, LinksThatWaitForAWitnessCondemnNoOthers) {
  World world(80);
  for (int i = 0; i < 23; ++i) world.exact(i, i + 1, i % 2 == 0 ? 0.975 : 0.9925);
  for (int i = 0; i < 253; ++i) world.wrong(24 + i % 56, i % 24, 0.01, Verdict::rejected);
  const Solution solution = solve(world.graph, {});
  for (int i = 0; i < 23; ++i)
    EXPECT_EQ(find_link(solution, i, i + 1)->link.result.verdict, i % 2 == 0 ? Verdict::ambiguous : Verdict::accepted)
        << i;
}

TEST(Solve, WhatABridgeLedToDoesNotHoldIt) {
  World world(60);
  for (const int first : {0, 5})
    for (int i = first; i < first + 4; ++i) world.exact(i, i + 1, 0.9999);
  world.exact(4, 5, 0.975);
  for (const auto& [a, b] : {std::pair(3, 6), std::pair(2, 7)}) world.exact(a, b, 0.99).guided = true;
  EXPECT_EQ(solve(world.graph, {}).components.front().scans.size(), 10u);
  for (int i = 0; i < 100; ++i) world.wrong(11 + i % 49, i % 10, 0.01, Verdict::rejected);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(solution.components.front().scans.size(), 5u);
  EXPECT_EQ(find_link(solution, 4, 5)->link.result.verdict, Verdict::ambiguous);
  EXPECT_EQ(find_link(solution, 3, 6)->link.result.verdict, Verdict::ambiguous);
}

// Loops refute four of this survey's links; what followed the link that no loop confirms goes with it.
TEST(Solve, WhatADoubtedBridgeLedToGoesWithIt) {
  const auto solved = [](bool guided) {
    World world(12);
    for (int i = 0; i < 8; ++i) world.exact(i, i + 1, 0.99);
    for (int i = 0; i < 7; ++i) world.exact(i, i + 2, 0.99);
    for (const auto& [a, b] : {std::pair(0, 5), std::pair(1, 6), std::pair(2, 7), std::pair(3, 8)})
      world.wrong(a, b, 0.98);
    for (const auto& [a, b] : {std::pair(9, 10), std::pair(10, 11), std::pair(9, 11)}) world.exact(a, b, 0.99);
    world.exact(8, 9, 0.95);
    for (const auto& [a, b] : {std::pair(7, 10), std::pair(6, 11)}) world.exact(a, b, 0.99).guided = guided;
    return solve(world.graph, {});
  };
  const Solution doubted = solved(true), held = solved(false);
  EXPECT_EQ(held.components.front().scans.size(), 12u);
  EXPECT_EQ(doubted.components.front().scans.size(), 9u);
  for (const auto& [a, b] : {std::pair(8, 9), std::pair(7, 10), std::pair(6, 11)}) {
    const SolvedLink* link = find_link(doubted, a, b);
    EXPECT_EQ(link->link.result.verdict, Verdict::rejected);
    EXPECT_NE(link->link.result.reason.find("no loop confirms it, and loops refute"), std::string::npos)
        << link->link.result.reason;
  }
}

TEST(Solve, BelievedLinksWeighByWhatTheyKnow) {
  World world(3);
  world.exact(1, 0), world.exact(2, 1);
  Link& rough = world.shifted(2, 0, 0.6 * kVoxel);
  rough.result.information /= 400;  // 20 cm
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(accepted(solution).size(), 3u);
  EXPECT_LT(worst_error_m(world, solution), 0.05 * kVoxel) << "equal weights leave a third of its error";
}

TEST(Solve, ALinkThatOverstatesItselfIsHeldBackByTheOthers) {
  World world(6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j)
      if (i != 3 || j != 0) world.right(i, j, 0.98, Verdict::accepted, 0.02);
  const double without = worst_error_m(world, solve(world.graph, {}));
  world.shifted(3, 0, kVoxel);
  const Solution solution = solve(world.graph, {});
  EXPECT_EQ(accepted(solution).size(), 15u);
  EXPECT_LT(worst_error_m(world, solution), without + 0.05 * kVoxel);
}

TEST(Solve, WhatFollowedOthersButMissesThePrecisePosesIsNotALink) {
  const auto verdict = [](double voxels, Verdict measured, bool guided) {
    World world(4);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j)
        if (i != 3 || j != 0) world.exact(i, j);
    world.shifted(3, 0, voxels * kVoxel, measured == Verdict::accepted ? 0.98 : 0.6, measured).guided = guided;
    const Solution solution = solve(world.graph, {});
    const PairResult result = find_link(solution, 3, 0)->link.result;
    if (result.verdict == Verdict::rejected) {
      EXPECT_LT(worst_error_m(world, solution), 0.01 * kVoxel) << "it bends nothing";
    }
    return result;
  };
  for (const double voxels : {0.7, 1.2}) {
    const PairResult promoted = verdict(voxels, Verdict::ambiguous, false),
                     guided = verdict(voxels, Verdict::accepted, true);
    EXPECT_EQ(promoted.verdict, Verdict::rejected);
    EXPECT_NE(promoted.reason.find("disagrees with the loop"), std::string::npos) << promoted.reason;
    EXPECT_EQ(guided.verdict, Verdict::rejected);
    EXPECT_EQ(verdict(voxels, Verdict::accepted, false).verdict, Verdict::accepted) << "it has a word of its own";
  }
  EXPECT_EQ(verdict(0.3, Verdict::ambiguous, false).verdict, Verdict::accepted);
  EXPECT_EQ(verdict(0.3, Verdict::accepted, true).verdict, Verdict::accepted);
}

TEST(Solve, UncertaintyGrowsAlongAChain) {
  World world(4);
  for (int i = 0; i + 1 < 4; ++i) world.exact(i, i + 1);
  const Solution solution = solve(world.graph, {});
  ASSERT_EQ(solution.components[0].anchor, 1);
  EXPECT_FALSE(solution.find(1)->sigma_m);
  // One link: the information's 1 cm, and its turn over the few metres to the scan's centre.
  EXPECT_NEAR(*solution.find(0)->sigma_m, 0.01, 1e-3);
  EXPECT_GT(*solution.find(3)->sigma_m, *solution.find(2)->sigma_m);
}

// Links that state a centimetre and err by `times` that: the loops tell, and the stated deviations follow.
TEST(Solve, UncertaintyIsWhatTheLoopsShowNotWhatLinksSay) {
  const auto ratio = [](double times) {  // of true errors to stated deviations, root mean square an axis
    double sum = 0;
    int n = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      constexpr int kScans = 8;
      World world(kScans, seed);
      for (int i = 0; i < kScans; ++i)
        for (int j = 0; j < i; ++j) world.right(i, j, 0.98, Verdict::accepted, 0.1 * times);
      const Solution solution = solve(world.graph, {});
      const int anchor = solution.components[0].anchor;
      for (const PlacedScan& scan : solution.scans) {
        if (!scan.sigma_m) continue;
        const auto t = predicted_target_from_source(solution, scan.id, anchor);
        const double error_m = displacement_m(*t, world.truth(scan.id, anchor), world.graph.scans[scan.id].centre);
        sum += std::pow(error_m / *scan.sigma_m, 2) / 3;
        ++n;
      }
    }
    return std::sqrt(sum / n);
  };
  for (const double times : {1.0, 4.0}) {
    EXPECT_GT(ratio(times), 0.4) << times;
    EXPECT_LT(ratio(times), 1.6) << times;
  }
}

}  // namespace
}  // namespace isthmus::testing
