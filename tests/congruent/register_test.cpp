#include "congruent/register.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "congruent/synthetic.h"

namespace isthmus::congruent {
namespace {

constexpr double kSpacing = 0.15;
constexpr double kTolerance = 1.5 * kSpacing;

struct Scene {
  test::Cloud source, target;
  Transform target_from_source;
};

using Sample = test::Cloud (*)(double, double, double, std::uint64_t, double, double);

// Two samplings of one surface; the target keeps x below the right edge, the source x above a left edge that leaves
// about `overlap` of the source's points in common.
Scene scene_of(Sample sample, double overlap, std::uint64_t seed) {
  Rng rng(seed);
  const Transform source_from_world = test::random_transform(rng, 20),
                  target_from_world = test::random_transform(rng, 20);
  // The source spans [a, 3], the target [-3, -a]: they share [a, -a], a share 2a / (a - 3) of the length.
  const double a = -3 * overlap / (2 - overlap);
  return {test::moved(sample(kSpacing, 0.01, 0.08, 2 * seed, a, 3), source_from_world),
          test::moved(sample(kSpacing, 0.01, 0.08, 2 * seed + 1, -3, -a), target_from_world),
          target_from_world * source_from_world.inverse()};
}
Scene yard_scene(double overlap, std::uint64_t seed) { return scene_of(test::sample_yard, overlap, seed); }

double error_m(const Scene& scene, const Transform& estimate) {
  double worst = 0;
  for (const auto& p : scene.source.points)
    worst = std::max(worst, displacement_m(scene.target_from_source, estimate, p.cast<double>()));
  return worst;
}

CongruentResult run(const Scene& scene, double overlap, std::uint64_t seed, const CongruentSearch& search = {}) {
  return register_congruent(scene.source.view(), scene.target.view(), kTolerance, overlap, seed, {}, search);
}

// Sampled twice as finely: at 40 % the coarse tolerance would let hills lie on other hills as well as on themselves.
test::Cloud fine_hills(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min,
                       double x_max) {
  return test::sample_hills(0.5 * spacing_m, noise_m, normal_noise_rad, seed, x_min, x_max);
}

struct Case {
  const char* name;
  Sample sample;
  double overlap;
  std::size_t ranks;  // the truth is looked for among that many best
  double tolerance_m = kTolerance;
  std::uint64_t num_seeds = 6;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class RecoversRandomPoses : public testing::TestWithParam<Case> {};

TEST_P(RecoversRandomPoses, OnNoisySurfaces) {
  const Case& c = GetParam();
  for (std::uint64_t seed = 0; seed < c.num_seeds; ++seed) {
    const Scene scene = scene_of(c.sample, c.overlap, seed);
    const auto result =
        register_congruent(scene.source.view(), scene.target.view(), c.tolerance_m, c.overlap, seed, {});
    ASSERT_FALSE(result.transforms.empty()) << seed << ": " << result.reason;
    EXPECT_TRUE(result.reason.empty());
    double nearest_m = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < std::min(c.ranks, result.transforms.size()); ++i)
      nearest_m = std::min(nearest_m, error_m(scene, result.transforms[i].target_from_source));
    EXPECT_LT(nearest_m, 0.5 * c.tolerance_m) << seed;
  }
}
// In the yard at low overlap, ground on ground and wall on wall often beat the truth: it is among the ten best.
INSTANTIATE_TEST_SUITE_P(
    Surfaces, RecoversRandomPoses,
    testing::Values(Case{"yard100", test::sample_yard, 1.0, 1}, Case{"yard80", test::sample_yard, 0.8, 1},
                    Case{"yard60", test::sample_yard, 0.6, 10}, Case{"hills100", test::sample_hills, 1.0, 1},
                    Case{"hills60", test::sample_hills, 0.6, 1}, Case{"balls60", test::sample_balls, 0.6, 1},
                    Case{"fine_hills40", fine_hills, 0.4, 1, 0.5 * kTolerance, 2}),
    [](const auto& instance) { return instance.param.name; });

TEST(RegisterCongruent, WorksWithoutNormals) {
  const Scene scene = yard_scene(1, 3);
  CongruentOptions options;
  options.use_normals = false;
  options.max_target_points = 600;
  options.max_congruent_sets = 200000;
  const auto result = register_congruent(scene.source.bare(), scene.target.bare(), kTolerance, 1, 3, options);
  ASSERT_FALSE(result.transforms.empty()) << result.reason;
  EXPECT_LT(error_m(scene, result.transforms.front().target_from_source), 2 * kTolerance);
}

TEST(RegisterCongruent, TransformsAreDistinctSortedAndScoredAsStated) {
  const Scene scene = yard_scene(0.6, 1);
  const auto result = run(scene, 0.6, 1);
  ASSERT_GT(result.transforms.size(), 1U);
  EXPECT_LE(result.transforms.size(), static_cast<std::size_t>(CongruentOptions{}.max_transforms));
  for (std::size_t i = 1; i < result.transforms.size(); ++i) {
    EXPECT_GE(result.transforms[i - 1].score, result.transforms[i].score);
    EXPECT_GT(error_m(scene, result.transforms[i].target_from_source) +
                  error_m(scene, result.transforms[0].target_from_source),
              kTolerance);
  }
}

CongruentSearch near(const Scene& scene, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : scene.source.points) mean += p.cast<double>();
  mean /= static_cast<double>(scene.source.points.size());
  Transform rough = scene.target_from_source * Eigen::Translation3d(mean);
  rough.rotate(rotation_from_vector(turn));
  rough.translate(-mean);
  rough.pretranslate(shift);
  return {.prior = CongruentPrior{rough, 0.2, 0.6}, .gravity = {}};
}

TEST(RegisterCongruent, APriorCutsTheWorkAndKeepsTheAnswer) {
  CongruentCounts free, bound;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = yard_scene(0.8, seed);
    const auto search = near(scene, {0.08, -0.06, 0.1}, {0.2, -0.2, 0.2});
    const auto result = run(scene, 0.8, seed, search);
    ASSERT_FALSE(result.transforms.empty()) << seed << ": " << result.reason;
    EXPECT_LT(error_m(scene, result.transforms.front().target_from_source), kTolerance) << seed;
    for (const auto& t : result.transforms)
      EXPECT_LE(
          rotation_angle_rad(t.target_from_source.linear() * search.prior->target_from_source.linear().transpose()),
          0.2 + 1e-9);
    free.distance_tests += run(scene, 0.8, seed).counts.distance_tests;
    bound.distance_tests += result.counts.distance_tests;
  }
  EXPECT_LT(bound.distance_tests * 10, free.distance_tests);
}

TEST(RegisterCongruent, AWrongPriorGivesNothingNearTheTruth) {
  const Scene scene = yard_scene(1, 2);
  auto search = near(scene, {0.8, 0.4, 0}, {2, 0, 0});
  for (const auto& t : run(scene, 1, 2, search).transforms) EXPECT_GT(error_m(scene, t.target_from_source), 0.5);
}

TEST(RegisterCongruent, GravityCutsThePairs) {
  const Scene scene = yard_scene(0.8, 4);
  Rng rng(4);
  const Transform source_from_yard = test::random_transform(rng, 20),
                  target_from_yard = test::random_transform(rng, 20);
  const CongruentSearch search{
      .prior = {},
      .gravity = CongruentGravity{source_from_yard.linear().col(2), target_from_yard.linear().col(2), 0.03}};
  const auto plain = run(scene, 0.8, 4), level = run(scene, 0.8, 4, search);
  ASSERT_FALSE(level.transforms.empty()) << level.reason;
  EXPECT_LT(error_m(scene, level.transforms.front().target_from_source), kTolerance);
  EXPECT_LT(static_cast<double>(level.counts.pairs) / level.counts.trials,
            0.5 * static_cast<double>(plain.counts.pairs) / plain.counts.trials);
}

TEST(RegisterCongruent, MovingEitherCloudMovesTheAnswer) {
  const Scene scene = yard_scene(1, 5);
  const auto still = run(scene, 1, 5);
  ASSERT_FALSE(still.transforms.empty());
  Rng rng(77);
  const Transform a = test::random_transform(rng, 50), b = test::random_transform(rng, 50);
  const Scene shifted{test::moved(scene.source, a), test::moved(scene.target, b),
                      b * scene.target_from_source * a.inverse()};
  const auto there = run(shifted, 1, 5);
  ASSERT_FALSE(there.transforms.empty());
  const Transform back = b.inverse() * there.transforms.front().target_from_source * a;
  EXPECT_LT(error_m(scene, back), kTolerance);
  EXPECT_NEAR(there.transforms.front().score, still.transforms.front().score, 0.03);
}

// Floats at 1e4 m resolve 1 mm: nothing is lost. At 1e6 m they resolve 6 cm: the input itself is that coarse, and the
// answer is as good as a tolerance above that allows.
TEST(RegisterCongruent, FarFromTheOriginTheInputsResolutionDecides) {
  const Scene near_origin = yard_scene(1, 6);
  for (const double away_m : {1e4, 1e6}) {
    Transform shift = Transform::Identity();
    shift.translation() = Eigen::Vector3d(away_m, -away_m, 0);
    const Scene scene{test::moved(near_origin.source, shift), test::moved(near_origin.target, shift),
                      shift * near_origin.target_from_source * shift.inverse()};
    const auto result = run(scene, 1, 6);
    ASSERT_FALSE(result.transforms.empty()) << away_m << ": " << result.reason;
    EXPECT_LT(error_m(scene, result.transforms.front().target_from_source), kTolerance) << away_m;
  }
}

void expect_same_bytes(const CongruentResult& a, const CongruentResult& b) {
  ASSERT_EQ(a.transforms.size(), b.transforms.size());
  for (std::size_t i = 0; i < a.transforms.size(); ++i) {
    EXPECT_EQ(std::memcmp(a.transforms[i].target_from_source.data(), b.transforms[i].target_from_source.data(),
                          16 * sizeof(double)),
              0);
    EXPECT_EQ(a.transforms[i].score, b.transforms[i].score);
    EXPECT_EQ(a.transforms[i].trial, b.transforms[i].trial);
  }
  EXPECT_EQ(std::memcmp(&a.counts, &b.counts, sizeof a.counts), 0);
}

TEST(RegisterCongruent, SameSeedSameBytesForAnyNumberOfThreads) {
  const Scene scene = yard_scene(0.6, 7);
  CongruentResult results[3];
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results[threads / 3] = run(scene, 0.6, 7);
  }
  ASSERT_FALSE(results[0].transforms.empty());
  expect_same_bytes(results[0], results[2]);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  expect_same_bytes(results[0], run(scene, 0.6, 7));
  EXPECT_NE(run(scene, 0.6, 8).counts.distance_tests, results[0].counts.distance_tests) << "the seed is not used";
}

// The overlap of the yard alone, with the rows that its two ends consist of marked.
struct MarkedScene {
  Scene scene;
  std::vector<std::uint8_t> marks;
  [[nodiscard]] OrientedCloud source() const { return {scene.source.points, scene.source.normals, marks}; }
};

MarkedScene marked_overlap(std::uint64_t seed) {
  constexpr double kEnd = 1.5, kRim = 0.4;
  const test::Cloud source = test::sample_yard(kSpacing, 0.01, 0.08, 2 * seed, -kEnd, kEnd);
  MarkedScene marked;
  for (const auto& p : source.points) marked.marks.push_back(std::abs(static_cast<double>(p.x())) > kEnd - kRim);
  Rng rng(seed);
  const Transform source_from_world = test::random_transform(rng, 5),
                  target_from_world = test::random_transform(rng, 5);
  marked.scene = {test::moved(source, source_from_world),
                  test::moved(test::sample_yard(kSpacing, 0.01, 0.08, 2 * seed + 1), target_from_world),
                  target_from_world * source_from_world.inverse()};
  return marked;
}

CongruentResult run_at_boundary(const MarkedScene& marked, std::uint64_t seed) {
  CongruentOptions options;
  options.bases = "boundary";
  return register_congruent(marked.source(), marked.scene.target.view(), kTolerance, 1, seed, options);
}

TEST(RegisterCongruent, BasesAtTheBoundaryFindTheTruthToo) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const MarkedScene marked = marked_overlap(seed);
    const CongruentResult result = run_at_boundary(marked, seed);
    ASSERT_FALSE(result.transforms.empty()) << result.reason;
    EXPECT_LT(error_m(marked.scene, result.transforms.front().target_from_source), 2 * kTolerance) << seed;
  }
}

TEST(RegisterCongruent, MarksOfTheBoundaryChangeNothingUnlessAskedFor) {
  const MarkedScene marked = marked_overlap(1);
  const CongruentResult with =
      register_congruent(marked.source(), marked.scene.target.view(), kTolerance, 1, 1, CongruentOptions{});
  expect_same_bytes(with, run(marked.scene, 1, 1));
  EXPECT_NE(run_at_boundary(marked, 1).counts.distance_tests, with.counts.distance_tests);
}

TEST(RegisterCongruent, BasesAtTheBoundaryAreTheSameForAnyNumberOfThreads) {
  const MarkedScene marked = marked_overlap(2);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return run_at_boundary(marked, 5);
  };
  const CongruentResult one = with_threads(1);
  ASSERT_FALSE(one.transforms.empty());
  expect_same_bytes(one, with_threads(7));
}

TEST(RegisterCongruent, MarksMustBeAsManyAsPoints) {
  MarkedScene marked = marked_overlap(1);
  marked.marks.pop_back();
  const CongruentResult result = run_at_boundary(marked, 1);
  EXPECT_TRUE(result.transforms.empty());
  EXPECT_NE(result.reason.find("marks of the boundary"), std::string::npos) << result.reason;
}

test::Cloud of_points(std::vector<Eigen::Vector3f> points) {
  test::Cloud cloud{std::move(points), {}};
  cloud.normals.assign(cloud.points.size(), Eigen::Vector3f(0, 0, 1));
  return cloud;
}

TEST(RegisterCongruent, UselessInputGivesAReasonAndNoTransform) {
  const test::Cloud yard = test::sample_yard(0.3, 0, 0, 1);
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 50; ++i) line.emplace_back(0.1F * static_cast<float>(i), 0, 0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::vector<Eigen::Vector3f>> useless{{},
                                                          {{1, 2, 3}},
                                                          {{0, 0, 0}, {1, 0, 0}},
                                                          {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                                          std::vector<Eigen::Vector3f>(50, Eigen::Vector3f(1, 1, 1)),
                                                          line,
                                                          std::vector<Eigen::Vector3f>(50, Eigen::Vector3f(nan, 0, 0))};
  for (const auto& points : useless) {
    const test::Cloud cloud = of_points(points);
    for (const auto& result : {register_congruent(cloud.view(), yard.view(), 0.3, 1, 1, {}),
                               register_congruent(yard.view(), cloud.view(), 0.3, 1, 1, {}),
                               register_congruent(cloud.view(), cloud.view(), 0.3, 1, 1, {})}) {
      EXPECT_TRUE(result.transforms.empty()) << points.size() << " points";
      EXPECT_FALSE(result.reason.empty());
    }
  }
  for (const double overlap : {0.0, -1.0, 1.5, std::nan("")})
    EXPECT_FALSE(register_congruent(yard.view(), yard.view(), 0.3, overlap, 1, {}).reason.empty());
  for (const double tolerance : {0.0, -1.0, std::nan(""), 1e-9})
    EXPECT_TRUE(register_congruent(yard.view(), yard.view(), tolerance, 1, 1, {}).transforms.empty());
  EXPECT_NE(register_congruent(yard.bare(), yard.view(), 0.3, 1, 1, {}).reason.find("normals"), std::string::npos);
}

TEST(RegisterCongruent, PointsThatAreNotFiniteDoNoHarm) {
  Scene scene = yard_scene(1, 8);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (auto* cloud : {&scene.source, &scene.target})
    for (std::size_t i = 5; i < cloud->points.size(); i += 17) {
      if (i % 3 == 0) cloud->points[i].y() = nan;
      if (i % 3 == 1) cloud->points[i].x() = inf;
      if (i % 3 == 2) cloud->normals[i] = Eigen::Vector3f::Zero();
    }
  const auto result = run(scene, 1, 8);
  ASSERT_FALSE(result.transforms.empty()) << result.reason;
  for (std::size_t i = scene.source.points.size(); i-- > 0;)
    if (!scene.source.points[i].allFinite())
      scene.source.points.erase(scene.source.points.begin() + static_cast<int>(i));
  EXPECT_LT(error_m(scene, result.transforms.front().target_from_source), kTolerance);
}

test::Cloud plane_of(int count) {
  std::vector<Eigen::Vector3f> points;
  Rng rng(1);
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(rng.uniform(0, 3)), y = static_cast<float>(rng.uniform(0, 2));
    points.emplace_back(x, y, 0.0F);
  }
  return of_points(points);
}

TEST(RegisterCongruent, ASparsePlaneIsRegisteredOntoItself) {
  const test::Cloud plane = plane_of(80);
  const auto result = register_congruent(plane.view(), plane.view(), 0.1, 1, 1, {});
  ASSERT_FALSE(result.transforms.empty()) << result.reason;
  const Transform& t = result.transforms.front().target_from_source;
  EXPECT_GT(t.linear()(2, 2), 0.99) << "stays in its plane, the same side up";
  EXPECT_NEAR(t.translation().z(), 0, 0.1);
  EXPECT_GT(result.transforms.front().score, 0.9);
}

TEST(RegisterCongruent, OnADensePlaneEveryBaseIsTooCommon) {
  const test::Cloud plane = plane_of(4000);
  const auto result = register_congruent(plane.view(), plane.view(), 0.06, 1, 1, {});
  EXPECT_TRUE(result.transforms.empty());
  EXPECT_NE(result.reason.find("too common"), std::string::npos) << result.reason;
}

TEST(RegisterCongruent, TooCommonBasesAreNamed) {
  const Scene scene = yard_scene(1, 9);
  CongruentOptions options;
  options.max_pairs = 1;
  const auto result = register_congruent(scene.source.view(), scene.target.view(), kTolerance, 1, 9, options);
  EXPECT_TRUE(result.transforms.empty());
  EXPECT_NE(result.reason.find("too common"), std::string::npos) << result.reason;
  EXPECT_EQ(result.counts.trials_too_common, result.counts.trials);
}

TEST(CongruentOptions, EveryDefaultLiesInItsRangeAndHasAReason) {
  const CongruentOptions defaults;
  for (const auto& row : congruent_options_table().rows) {
    EXPECT_FALSE(row.help.empty()) << row.key;
    EXPECT_FALSE(row.source.empty()) << row.key;
    if (const auto* d = std::get_if<double CongruentOptions::*>(&row.member)) {
      EXPECT_GE(defaults.**d, row.min) << row.key;
      EXPECT_LE(defaults.**d, row.max) << row.key;
    }
    if (const auto* i = std::get_if<int CongruentOptions::*>(&row.member)) {
      EXPECT_GE(defaults.**i, row.min) << row.key;
      EXPECT_LE(defaults.**i, row.max) << row.key;
    }
  }
}

}  // namespace
}  // namespace isthmus::congruent
