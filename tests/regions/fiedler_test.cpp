#include "regions/fiedler.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "base/rng.h"

namespace isthmus {
namespace {

using Tie = WeightedGraph::Tie;

TEST(WeightedGraph, CountsATieOnceAndLeavesOutLoops) {
  const std::vector<Tie> ties{{0, 1, 0.5}, {1, 0, 0.7}, {1, 2, 0.1}, {2, 2, 9}};
  const WeightedGraph graph(4, ties);
  EXPECT_DOUBLE_EQ(graph.degree(0), 0.7);
  EXPECT_DOUBLE_EQ(graph.degree(1), 0.8);
  EXPECT_DOUBLE_EQ(graph.degree(2), 0.1);
  EXPECT_EQ(graph.around(1).size(), 2U);
  EXPECT_TRUE(graph.around(3).empty());
  EXPECT_EQ(graph.components(), (std::vector<std::vector<std::uint32_t>>{{0, 1, 2}, {3}}));
  const std::vector<std::uint32_t> some{2, 1};
  const WeightedGraph part = graph.part(some);
  EXPECT_EQ(part.size(), 2U);
  EXPECT_DOUBLE_EQ(part.degree(0), 0.1);
  EXPECT_DOUBLE_EQ(part.degree(1), 0.1);
}

TEST(FiedlerPositions, OfARingLieOnACosine) {
  // All degrees are equal, so the answer is an eigenvector of the ring: a cosine of one period and any phase.
  constexpr std::uint32_t kNodes = 24;
  std::vector<Tie> ties;
  for (std::uint32_t i = 0; i < kNodes; ++i) ties.push_back({i, (i + 1) % kNodes, 1});
  const auto y = fiedler_positions(WeightedGraph(kNodes, ties));
  double cosine = 0, sine = 0, all = 0;
  for (std::uint32_t i = 0; i < kNodes; ++i) {
    const double angle = 2 * std::numbers::pi * i / kNodes;
    cosine += y[i] * std::cos(angle), sine += y[i] * std::sin(angle), all += y[i] * y[i];
  }
  EXPECT_NEAR((cosine * cosine + sine * sine) / (all * kNodes / 2), 1, 1e-9);
}

TEST(FiedlerPositions, AgreeWithADenseSolver) {
  constexpr int kNodes = 150;
  Rng rng(4);
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < kNodes; ++i) {
    const double x = rng.uniform(0, 3), y = rng.uniform(0, 1);
    places.emplace_back(x, y);
  }
  std::vector<Tie> ties;
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(kNodes, kNodes);
  for (std::uint32_t i = 0; i < kNodes; ++i)
    for (std::uint32_t j = 0; j < i; ++j) {
      const double sq = (places[i] - places[j]).squaredNorm();
      if (sq > 0.3) continue;
      ties.push_back({i, j, std::exp(-sq / 0.05)});
      w(i, j) = w(j, i) = ties.back().weight;
    }
  const WeightedGraph graph(kNodes, ties);
  ASSERT_EQ(graph.components().size(), 1U);
  const Eigen::VectorXd root = w.rowwise().sum().cwiseSqrt();
  const Eigen::MatrixXd laplacian = Eigen::MatrixXd::Identity(kNodes, kNodes) -
                                    root.cwiseInverse().asDiagonal() * w * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian);
  const Eigen::VectorXd exact = solver.eigenvectors().col(1);
  const auto y = fiedler_positions(graph);
  const Eigen::VectorXd ours = Eigen::Map<const Eigen::VectorXd>(y.data(), kNodes).cwiseProduct(root).normalized();
  EXPECT_NEAR(std::abs(ours.dot(exact)), 1, 1e-6);
}

TEST(FiedlerPositions, OfFewNodes) {
  EXPECT_TRUE(fiedler_positions(WeightedGraph(0, {})).empty());
  EXPECT_EQ(fiedler_positions(WeightedGraph(1, {})).size(), 1U);
  const std::vector<Tie> tie{{0, 1, 2}};
  const auto y = fiedler_positions(WeightedGraph(2, tie));
  EXPECT_LT(y[0] * y[1], 0);
}

}  // namespace
}  // namespace isthmus
