// Noise is measured, and surfaces thicker than the voxel are thinned to the middle of it.
#include "scan/thinning.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "scan/sample_points.h"
#include "store/archive.h"

namespace isthmus {
namespace {

using testing::furnished_hall;
using testing::Points;
using testing::pose_of;
using testing::sampled;
using testing::scan_scene;

Points noisy(Points points, double sigma_m, std::uint64_t seed = 11) {
  Rng rng(seed);
  for (auto& p : points)
    for (int a = 0; a < 3; ++a) p[a] += static_cast<float>(sigma_m * rng.normal());
  return points;
}

// `sides` squares of 6 m that meet at the origin at right angles, points every 4 cm.
Points corner(int sides) {
  constexpr int kAcross = 150;
  Points points;
  for (int a = 0; a < sides; ++a)
    for (int i = 0; i < kAcross; ++i)
      for (int j = 0; j < kAcross; ++j) {
        Eigen::Vector3f p;
        p[a] = 0;
        p[(a + 1) % 3] = 0.04f * static_cast<float>(i);
        p[(a + 2) % 3] = 0.04f * static_cast<float>(j);
        points.push_back(p);
      }
  return points;
}

double noise_of_points(const Points& points) {
  const std::vector<std::uint32_t> ones(points.size(), 1);
  return noise_m({points, {}, ones}, 0.1, 3);
}

std::vector<Eigen::Vector3f> thinned_points(const Points& points, double noise_m) {
  const std::vector<std::uint32_t> ones(points.size(), 1);
  std::vector<Eigen::Vector3f> out;
  for (const RidgePoint& p : thinned(points, {points, {}, ones}, noise_m)) out.push_back(p.point);
  return out;
}

// Of the points at least `inside_m` within the first side: root mean square of what they stand off it.
double rms_off_first_side(const Points& points, float inside_m) {
  double sum = 0;
  std::size_t n = 0;
  for (const auto& p : points) {
    if (std::min(p.y(), p.z()) < inside_m || std::max(p.y(), p.z()) > 6 - inside_m) continue;
    if (std::abs(p.x()) > 1) continue;
    sum += static_cast<double>(p.x() * p.x());
    ++n;
  }
  EXPECT_GT(n, 100u);
  return std::sqrt(sum / static_cast<double>(n));
}

TEST(Noise, IsTheDeviationAlongTheNormal) {
  for (const double sigma_m : {0.02, 0.05, 0.15})
    EXPECT_NEAR(noise_of_points(noisy(corner(3), sigma_m)), sigma_m, 0.2 * sigma_m);
  EXPECT_LT(noise_of_points(corner(3)), 0.001);
}

TEST(Noise, OfMomentsIsThatOfThePointsTheyStandFor) {
  const Points points = noisy(corner(1), 0.05);
  std::vector<Eigen::Vector3f> means;
  std::vector<Eigen::Matrix3f> covariances;
  const std::vector<std::uint32_t> fours(points.size() / 4, 4);
  for (std::size_t i = 0; i + 3 < points.size(); i += 4) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
    for (std::size_t k = i; k < i + 4; ++k) mean += points[k] / 4, second += points[k] * points[k].transpose() / 4;
    means.push_back(mean);
    covariances.emplace_back(second - mean * mean.transpose());
  }
  EXPECT_NEAR(noise_m({means, covariances, fours}, 0.2, 3), 0.05, 0.01);
  EXPECT_LT(noise_m({means, {}, fours}, 0.2, 3), 0.035) << "means of four alone stand off by half";
}

TEST(Noise, IsNoneWhereNothingIsFlat) {
  Rng rng(3);
  Points cloud;
  for (int k = 0; k < 20000; ++k)
    cloud.emplace_back(static_cast<float>(rng.uniform(0, 4)), static_cast<float>(rng.uniform(0, 4)),
                       static_cast<float>(rng.uniform(0, 4)));
  EXPECT_EQ(noise_of_points(cloud), 0);
}

TEST(Thinning, PointsComeToLieInTheMiddle) {
  constexpr double kSigma = 0.1;
  const Points wall = noisy(corner(1), kSigma);
  EXPECT_NEAR(rms_off_first_side(wall, 0.5f), kSigma, 0.005);
  EXPECT_LT(rms_off_first_side(thinned_points(wall, kSigma), 0.5f), 0.12 * kSigma);
}

TEST(Thinning, SidesOfACornerStayWhereTheyAre) {
  constexpr double kSigma = 0.1;
  Points sides = noisy(corner(3), kSigma);
  const Points thin = thinned_points(sides, kSigma);
  Points first(thin.begin(), thin.begin() + 150 * 150);
  EXPECT_LT(rms_off_first_side(first, 0.6f), 0.25 * kSigma);
}

TEST(Thinning, PointsMoveAlongTheNormalOnly) {
  const Points wall = noisy(corner(1), 0.1);
  const Points thin = thinned_points(wall, 0.1);
  for (std::size_t i = 0; i < wall.size(); i += 97) {
    if (std::min(wall[i].y(), wall[i].z()) < 1 || std::max(wall[i].y(), wall[i].z()) > 5) continue;
    EXPECT_LT((thin[i] - wall[i]).tail<2>().norm(), 0.06f);
  }
}

TEST(Thinning, APointAloneStays) {
  const Points alone{{1, 2, 3}, {50, 0, 0}};
  EXPECT_EQ(thinned_points(alone, 0.1), alone);
}

TEST(Thinning, DoesNotDependOnThreadsOrChunks) {
  const Points points = noisy(scan_scene(furnished_hall(2), pose_of({0, 0, 1.7}), {60000, 1e6, 0.002, 5}), 0.15);
  testing::SamplingSetup small;
  small.chunk = 1000;
  std::string alone;
  tbb::task_arena(1).execute([&] { alone = store::to_bytes(sampled(points, 0.2)); });
  EXPECT_EQ(store::to_bytes(sampled(points, 0.2)), alone);
  EXPECT_EQ(store::to_bytes(sampled(points, 0.2, small)), alone);
}

// Half of a voxel and more of noise is taken out; the scan keeps fewer voxels, on surfaces that are smooth.
TEST(Thinning, ANoisyScanIsSampledAlmostAsACleanOne) {
  constexpr double kVoxel = 0.2, kSigma = 0.13;
  const Points clean_points = scan_scene(furnished_hall(2), pose_of({0, 0, 1.7}), {200000, 1e6, 0.002, 5});
  const SampledScan clean = sampled(clean_points, kVoxel), thin = sampled(noisy(clean_points, kSigma), kVoxel);
  EXPECT_LT(static_cast<double>(thin.points.size()), 1.2 * static_cast<double>(clean.points.size()))
      << "as it stood the noise made several layers";
  const auto median = [](std::vector<float> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  EXPECT_LT(median(thin.variation), 0.02f);
  EXPECT_EQ(thin.station_kind, StationKind::origin);
  EXPECT_TRUE(std::ranges::any_of(thin.notes, [](const std::string& n) { return n.find("noise") != n.npos; }));
  EXPECT_TRUE(std::ranges::none_of(clean.notes, [](const std::string& n) { return n.find("noise") != n.npos; }));
}

}  // namespace
}  // namespace isthmus
