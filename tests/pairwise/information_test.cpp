// The information matrix against finite differences of the point-to-plane cost under T * exp(d), d = (translation,
// rotation vector) in the source frame.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "pairwise/pair_options_for_tests.h"
#include "regions/hall_pair.h"

namespace isthmus {
namespace {

using testing::pose_of;

struct Match {
  Eigen::Vector3d p_in_source, q, n;
};

std::vector<Match> matches_at(const ScanModel& source, const ScanModel& target, const Transform& t) {
  std::vector<Match> out;
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const Eigen::Vector3d p = t * source.points[i].cast<double>();
    const std::int32_t j = target.fine.near(p.cast<float>());
    if (j < 0 || target.variation[static_cast<std::size_t>(j)] >= 1) continue;
    const Eigen::Vector3d n = target.normals[static_cast<std::size_t>(j)].cast<double>();
    if (n.dot(t.linear() * source.normals[i].cast<double>()) < 0.5) continue;
    const Eigen::Vector3d q = target.points[static_cast<std::size_t>(j)].cast<double>();
    if (std::abs(n.dot(p - q)) > 0.02) continue;  // corners, where the normal is smeared
    out.push_back({source.points[i].cast<double>(), q, n});
  }
  return out;
}

double cost(const std::vector<Match>& matches, const Transform& t, const Vector6d& d) {
  const Transform moved = t * pose_of(d.head<3>(), d.tail<3>());
  double sum = 0;
  for (const Match& m : matches) {
    const double r = m.n.dot(moved * m.p_in_source - m.q);
    sum += r * r;
  }
  return sum;
}

Matrix6d half_hessian(const std::vector<Match>& matches, const Transform& t) {
  constexpr double kStep = 1e-3;
  Matrix6d h;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const auto at = [&](double si, double sj) {
        Vector6d d = Vector6d::Zero();
        d[i] += si, d[j] += sj;
        return cost(matches, t, d);
      };
      h(i, j) =
          0.5 * (at(kStep, kStep) - at(kStep, -kStep) - at(-kStep, kStep) + at(-kStep, -kStep)) / (4 * kStep * kStep);
    }
  return h;
}

// The hall without noise; the source is turned and lies far from its own origin, so that frames, sides and order all
// show.
TEST(Information, IsTheCurvatureOfTheCostUnderARightPerturbation) {
  const testing::Scene scene = testing::furnished_hall(1);
  const Transform offset = pose_of({12, -7, 4});
  testing::SamplingSetup setup;
  setup.header.station_in_scan = offset.translation();
  const Transform world_from_station = pose_of({-2, -1, 1.7}, {0.3, -0.2, 2.1}),
                  world_from_target = pose_of({2, 0.7, 1.8});
  const ScanProduct source = testing::product_of(
      testing::moved(testing::scan_scene(scene, world_from_station, {60000, 9, 0, 1}), offset), 0.2, setup);
  const ScanProduct target = testing::product_of(testing::scan_scene(scene, world_from_target, {60000, 9, 0, 2}), 0.2);
  const Transform truth = world_from_target.inverse() * world_from_station * offset.inverse();
  const PairResult result = register_pair(source, target, testing::no_search(), std::span(&truth, 1));
  ASSERT_TRUE(result.target_from_source);
  ASSERT_LT(testing::largest_displacement_m(source, *result.target_from_source, truth), 0.1);

  const ScanModel fine_source(source.sampled, source.features, source.regions, ModelLevel::fine);
  const ScanModel fine_target(target.sampled, target.features, target.regions, ModelLevel::fine);
  const auto matches = matches_at(fine_source, fine_target, *result.target_from_source);
  ASSERT_GT(matches.size(), 500u);
  const Matrix6d expected = half_hessian(matches, *result.target_from_source);
  // The unit of the residuals (noise, independence of neighbours) is one factor for the whole matrix.
  const double factor = result.information.topLeftCorner<3, 3>().trace() / expected.topLeftCorner<3, 3>().trace();
  ASSERT_GT(factor, 0);
  for (const auto& [row, column] : {std::pair(0, 0), std::pair(0, 3), std::pair(3, 0), std::pair(3, 3)}) {
    const Eigen::Matrix3d a = result.information.block<3, 3>(row, column) / factor,
                          b = expected.block<3, 3>(row, column);
    EXPECT_LT((a - b).norm(), 0.1 * b.norm()) << "block " << row << ", " << column << "\n" << a << "\n\n" << b;
  }
}

TEST(Information, IsSymmetricAndNeverNegative) {
  const testing::HallPair pair({0.5, 0.1, 1});
  const Transform& truth = pair.data.target_from_source;
  const PairResult result =
      register_pair(pair.data.source, pair.data.target, testing::no_search(), std::span(&truth, 1));
  EXPECT_EQ(result.information, result.information.transpose());
  const Vector6d values = Eigen::SelfAdjointEigenSolver<Matrix6d>(result.information).eigenvalues();
  EXPECT_GT(values[0], 0) << "a hall fixes every direction";
}

// Two scans of one wall know nothing of sliding along it.
TEST(Information, IsNearZeroWhereThePairSlides) {
  testing::Scene wall;
  wall.add_rectangle({5, -4, -2}, {0, 8, 0}, {0, 0, 4});
  testing::SamplingSetup setup;
  setup.options.station = "origin";  // a bare wall does not show on which side its station was
  const auto scan = [&](std::uint64_t seed) {
    return testing::product_of(testing::scan_scene(wall, pose_of({0, 0, 0}), {100000, 1e6, 0, seed}), 0.2, setup);
  };
  const ScanProduct one = scan(1), two = scan(2);
  const Transform truth = Transform::Identity();
  const PairResult result = register_pair(one, two, testing::no_search(), std::span(&truth, 1));
  ASSERT_TRUE(result.target_from_source);
  const Eigen::Matrix3d translation = result.information.topLeftCorner<3, 3>();
  EXPECT_GT(translation(0, 0), 0);
  EXPECT_LT(translation(1, 1), 0.01 * translation(0, 0));
  EXPECT_LT(translation(2, 2), 0.01 * translation(0, 0));
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix6d>(result.information).eigenvalues()[0],
            -1e-6 * result.information.norm());
}

}  // namespace
}  // namespace isthmus
