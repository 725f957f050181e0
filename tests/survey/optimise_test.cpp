// Graduated non-convexity on its own, without the loop check before it.
#include "survey/optimise.h"

#include <gtest/gtest.h>

#include "survey/spanning_forest.h"
#include "survey/synthetic_survey.h"

namespace isthmus::survey {
namespace {

using isthmus::testing::World;

std::vector<Measurement> measurements_of(const World& world) {
  std::vector<Measurement> out;
  for (const Link& link : world.graph.links) {
    const GraphScan& source = world.graph.scans[link.source];
    MeasurementOrReason m =
        measurement_of(link, source, world.graph.scans[link.target], noise_model(world.graph, source, {}));
    m.measurement.source = link.source;
    m.measurement.target = link.target;
    out.push_back(m.measurement);
  }
  return out;
}

TEST(Optimise, GraduatedNonConvexityDropsOutliers) {
  World world(10, 11);
  for (int i = 0; i < 10; ++i) world.right(i, (i + 1) % 10), world.right(i, (i + 2) % 10), world.right(i, (i + 3) % 10);
  world.wrong(0, 5), world.wrong(2, 7), world.wrong(4, 9);
  const std::vector<Measurement> m = measurements_of(world);
  std::vector<int> chain;
  for (int i = 0; i < 9; ++i) chain.push_back(3 * i);
  const SpanningForest forest = forest_of(10, m, chain);
  const OptimisedPoses solved = optimise(forest.root_from_node, m, {0}, 22.46);
  EXPECT_EQ(solved.problem, "");
  for (std::size_t e = 0; e < m.size(); ++e) EXPECT_EQ(solved.weights[e], e < 30 ? 1.0 : 0.0) << e;
  for (int i = 0; i < 10; ++i) {
    const Transform centred_truth = Eigen::Translation3d(-world.graph.scans[0].centre) * world.truth(i, 0) *
                                    Eigen::Translation3d(world.graph.scans[i].centre);
    EXPECT_LT((centred_truth.inverse() * solved.root_from_node[i]).translation().norm(), isthmus::testing::kVoxel);
  }
}

/// The optimum of a small problem against brute-force coordinate descent on the same cost.
TEST(Optimise, FindsTheLeastSquaresMinimum) {
  World world(4, 2);
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) world.right(i, j);
  const std::vector<Measurement> m = measurements_of(world);
  const SpanningForest forest = forest_of(4, m, {0, 1, 2});
  const OptimisedPoses solved = optimise(forest.root_from_node, m, {0}, 22.46);
  const auto cost = [&](const std::vector<Transform>& poses) {
    double sum = 0;
    for (const Measurement& one : m) sum += chi2_at(one, poses);
    return sum;
  };
  const double best = cost(solved.root_from_node);
  EXPECT_LE(best, cost(forest.root_from_node));
  for (int node = 1; node < 4; ++node)
    for (int k = 0; k < 6; ++k)
      for (const double step : {-1e-4, 1e-4}) {
        std::vector<Transform> nudged = solved.root_from_node;
        Vector6d d = Vector6d::Zero();
        d[k] = step;
        nudged[node] = nudged[node] * isthmus::testing::exp_of(d);
        EXPECT_GE(cost(nudged), best) << node << ' ' << k;
      }
}

TEST(LinkModel, CompositionCarriesCovarianceAsSampling) {
  Rng rng(17);
  Relative b_from_a{isthmus::testing::random_pose(rng, 3.0), Matrix6d::Identity() * 1e-6};
  Relative c_from_b{isthmus::testing::random_pose(rng, 3.0), Matrix6d::Identity() * 4e-6};
  b_from_a.covariance(0, 3) = b_from_a.covariance(3, 0) = 5e-7;
  const Relative c_from_a = compose(c_from_b, b_from_a);
  const Relative a_from_c = inverse(c_from_a);
  const auto draw = [&](const Relative& r) {
    const Matrix6d root = Matrix6d(r.covariance.llt().matrixL());
    Vector6d white;
    for (int k = 0; k < 6; ++k) white[k] = rng.normal();
    return Transform(r.b_from_a * isthmus::testing::exp_of(root * white));
  };
  Matrix6d sampled = Matrix6d::Zero(), sampled_inverse = Matrix6d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Transform t = draw(c_from_b) * draw(b_from_a);
    const Vector6d d = disagreement(c_from_a.b_from_a, t);
    const Vector6d e = disagreement(a_from_c.b_from_a, t.inverse());
    sampled += d * d.transpose() / kDraws;
    sampled_inverse += e * e.transpose() / kDraws;
  }
  EXPECT_LT((sampled - c_from_a.covariance).norm(), 0.05 * c_from_a.covariance.norm());
  EXPECT_LT((sampled_inverse - a_from_c.covariance).norm(), 0.05 * a_from_c.covariance.norm());
}

}  // namespace
}  // namespace isthmus::survey
