#include "features/iss.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "pairwise/synthetic_scene.h"

namespace isthmus {
namespace {

using Points = testing::Points;

// Zhong 2009 by its definition: every pair of points, iterative eigenvalues.
std::vector<double> brute_third_eigenvalues(const Points& points, double radius_m, double gamma) {
  std::vector<double> third(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    int n = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Eigen::Vector3d d = (points[j] - points[i]).cast<double>();
      if (d.norm() > radius_m) continue;
      scatter += d * d.transpose();
      ++n;
    }
    if (n < 6) continue;
    const Eigen::Vector3d l = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter / n).eigenvalues();
    if (l[1] / l[2] < gamma && l[0] / l[1] < gamma) third[i] = l[0];
  }
  return third;
}

std::vector<double> brute_saliency(const Points& points, double radius_m, double non_max_radius_m, double gamma) {
  const std::vector<double> third = brute_third_eigenvalues(points, radius_m, gamma);
  std::vector<double> saliency(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double largest = 0;
    for (std::size_t j = 0; j < points.size(); ++j)
      if ((points[j] - points[i]).cast<double>().norm() <= non_max_radius_m) largest = std::max(largest, third[j]);
    if (third[i] > 0 && third[i] == largest) saliency[i] = third[i];
  }
  return saliency;
}

Points random_cloud(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i)
    points.emplace_back(Eigen::Vector3d(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-0.4, 0.4)).cast<float>());
  return points;
}

// The corner of a box: three faces of 11 x 11 points, 0.1 m apart, meeting at the origin.
Points box_corner() {
  Points points;
  for (int a = 0; a < 3; ++a)
    for (int u = a == 0 ? 0 : 1; u <= 10; ++u)
      for (int v = a == 2 ? 1 : 0; v <= 10; ++v) {
        Eigen::Vector3f p = Eigen::Vector3f::Zero();
        p[(a + 1) % 3] = 0.1f * static_cast<float>(u), p[(a + 2) % 3] = 0.1f * static_cast<float>(v);
        points.push_back(p);
      }
  return points;
}

TEST(Iss, IsTheDefinition) {
  for (const double gamma : {0.6, 0.95}) {
    const Points points = random_cloud(900, 3);
    const auto saliency = iss_saliency(points, 0.5f, 0.3f, static_cast<float>(gamma));
    const auto expected = brute_saliency(points, 0.5, 0.3, gamma);
    std::size_t keypoints = 0, different = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      keypoints += expected[i] > 0;
      if ((saliency[i] > 0) != (expected[i] > 0))
        ++different;  // a ratio at the very threshold
      else
        EXPECT_NEAR(saliency[i], expected[i], 1e-5 * expected[i] + 1e-12);
    }
    EXPECT_GT(keypoints, 20u);
    EXPECT_LE(different, 2u);
  }
}

TEST(Iss, KeypointsLieAtTheCornerNotOnTheFaces) {
  const Points points = box_corner();
  const auto saliency = iss_saliency(points, 0.35f, 0.2f, 0.95f);
  float at_corner = 0, on_faces = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inner_face = (points[i].array() > 0.36f).count() == 2;
    (inner_face ? on_faces : at_corner) = std::max(inner_face ? on_faces : at_corner, saliency[i]);
  }
  EXPECT_GT(at_corner, 1e-4f);
  EXPECT_LT(on_faces, 1e-3f * at_corner);
}

TEST(Iss, TwoKeypointsAreFartherApartThanTheSuppressionRadius) {
  const Points points = random_cloud(1500, 8);
  const auto saliency = iss_saliency(points, 0.4f, 0.25f, 0.95f);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if (saliency[i] > 0 && saliency[j] > 0) {
        EXPECT_GT((points[i] - points[j]).norm(), 0.25f);
      }
}

TEST(Iss, TooFewNeighboursIsNoKeypoint) {
  EXPECT_TRUE(iss_saliency({}, 1, 1, 0.95f).empty());
  const Points few{{0, 0, 0}, {0.1f, 0, 0}, {0, 0.3f, 0}, {0, 0, 0.2f}, {0.1f, 0.2f, 0.1f}};
  for (const float s : iss_saliency(few, 1, 1, 0.95f)) EXPECT_EQ(s, 0);
  for (const float s : iss_saliency(Points(50, Eigen::Vector3f(1, 2, 3)), 1, 1, 0.95f)) EXPECT_EQ(s, 0);
}

}  // namespace
}  // namespace isthmus
