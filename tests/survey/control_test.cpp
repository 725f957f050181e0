// Surveys laid into a world by known points, poses and levels.
#include <gtest/gtest.h>

#include <numbers>

#include "survey/synthetic_survey.h"

namespace isthmus {
namespace {

using testing::World;

const Eigen::Vector3d kMap(500123.0, 5240456.0, 412.0);

/// A ring of scans; the world frame of the map is that of the synthetic world, moved far away and turned.
struct MappedRing {
  World world;
  Transform map_from_world = Transform::Identity();

  explicit MappedRing(int scans = 8) : world(scans) {
    map_from_world.linear() = rotation_from_vector({0.02, -0.01, 1.1});
    map_from_world.translation() = kMap;
    for (int i = 0; i < scans; ++i) world.right((i + 1) % scans, i);
    for (int i = 0; i + 2 < scans; ++i) world.right(i + 2, i);
  }
  [[nodiscard]] Transform map_from_local(int scan) const { return map_from_world * world.world_from_local[scan]; }
  [[nodiscard]] ControlPoint point(int scan, const Eigen::Vector3d& p_in_local, double off_m = 0) const {
    ControlPoint p;
    p.name = fmt::format("P{}", scan);
    p.scan = scan;
    p.p_in_local = p_in_local;
    p.p_in_world = map_from_local(scan) * p_in_local + Eigen::Vector3d(off_m, 0, 0);
    p.sigma_m.setConstant(0.01);
    return p;
  }
  [[nodiscard]] Control points(int count) const {
    Control control;
    for (int k = 0; k < count; ++k) control.points.push_back(point(k, {3.0, 2.0 * k, 1.0 - k}));
    return control;
  }
  /// Largest error of a scan's centre in the map.
  [[nodiscard]] double worst_m(const Solution& solution) const {
    double worst = 0;
    for (const PlacedScan& scan : solution.scans) {
      const auto& world_frame = solution.components.at(static_cast<std::size_t>(scan.component)).georeference;
      if (!world_frame) return 1e9;
      const Eigen::Vector3d& centre = world.graph.scans[static_cast<std::size_t>(scan.id)].centre;
      const Eigen::Vector3d shifted = world_frame->shifted_from_component * (scan.component_from_local * centre);
      const Eigen::Vector3d known = map_from_local(scan.id) * centre - world_frame->shift_m;
      worst = std::max(worst, (shifted - known).norm());
    }
    return worst;
  }
};

TEST(Control, PointsLayTheSurveyIntoTheMap) {
  const MappedRing ring;
  const Solution solution = solve(ring.world.graph, {}, ring.points(5));
  EXPECT_LT(ring.worst_m(solution), 0.06);
  ASSERT_EQ(solution.control.size(), 5U);
  for (const ControlResult& r : solution.control) {
    EXPECT_TRUE(r.used) << r.reason;
    ASSERT_TRUE(r.before && r.after);
    EXPECT_LE(r.after->norm(), 0.03);
  }
  // The shift is a round number that leaves small ones.
  const Eigen::Vector3d& shift = solution.components[0].georeference->shift_m;
  EXPECT_EQ(shift, Eigen::Vector3d(500100, 5240400, 400)) << shift.transpose();
}

TEST(Control, TighterThanTheLinksItCorrectsThem) {
  MappedRing ring;
  // A chain with a drift of 5 cm a link.
  ring.world.graph.links.clear();
  for (int i = 0; i + 1 < 8; ++i) ring.world.shifted(i + 1, i, 0.05);
  const Control control = ring.points(8);
  const Solution free = solve(ring.world.graph, {}), held = solve(ring.world.graph, {}, control);
  EXPECT_LT(ring.worst_m(held), 0.1);
  for (const ControlResult& r : held.control) EXPECT_LT(r.after->norm(), r.before->norm() + 1e-3);
  EXPECT_EQ(free.components[0].georeference, std::nullopt);
}

TEST(Control, GrossErrorIsNamedAndBendsNothing) {
  const MappedRing ring;
  Control control = ring.points(5);
  control.points[2].p_in_world.x() += 1.0;
  const Solution with = solve(ring.world.graph, {}, control);
  EXPECT_FALSE(with.control[2].used);
  EXPECT_NE(with.control[2].reason.find("m off where the others put it"), std::string::npos) << with.control[2].reason;
  EXPECT_LT(ring.worst_m(with), 0.06);
  EXPECT_TRUE(
      std::ranges::any_of(with.warnings, [](const std::string& w) { return w.starts_with("control P2: not used"); }));
  for (const int k : {0, 1, 3, 4}) EXPECT_TRUE(with.control[static_cast<std::size_t>(k)].used);
}

TEST(Control, ContradictionWithoutMajorityPlacesNothing) {
  const MappedRing ring;
  Control control = ring.points(3);
  control.points[1].p_in_world.x() += 2.0;
  const Solution solution = solve(ring.world.graph, {}, control);
  EXPECT_FALSE(solution.components[0].georeference);
  for (const ControlResult& r : solution.control) {
    EXPECT_FALSE(r.used);
    EXPECT_NE(r.reason.find("nothing tells which item is wrong"), std::string::npos) << r.reason;
  }
  // And the survey is what it is without control.
  const Solution free = solve(ring.world.graph, {});
  for (std::size_t i = 0; i < free.scans.size(); ++i)
    EXPECT_TRUE(solution.scans[i].component_from_local.isApprox(free.scans[i].component_from_local, 1e-9));
}

TEST(Control, TwoPointsNeedALevelScan) {
  MappedRing ring;
  ring.map_from_world.linear() = rotation_from_vector({0, 0, 1.1});
  for (Transform& pose : ring.world.world_from_local) {  // all level
    const double heading = std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
    pose.linear() = rotation_from_vector({0, 0, heading});
  }
  ring.world.graph.links.clear();
  for (int i = 0; i < 8; ++i) ring.world.right((i + 1) % 8, i);
  Control control = ring.points(2);
  Solution solution = solve(ring.world.graph, {}, control);
  EXPECT_FALSE(solution.components[0].georeference);
  EXPECT_NE(solution.control[0].reason.find("three points that are not in one line"), std::string::npos);
  for (int i = 0; i < 8; ++i) control.levelled.push_back({i, 0.05 * std::numbers::pi / 180});
  solution = solve(ring.world.graph, {}, control);
  ASSERT_TRUE(solution.components[0].georeference);
  EXPECT_LT(ring.worst_m(solution), 0.15);
  EXPECT_TRUE(std::ranges::all_of(solution.control, &ControlResult::used));
}

TEST(Control, KnownPoseIsEnough) {
  const MappedRing ring;
  Control control;
  control.poses.push_back({"s3", 3, ring.map_from_local(3), 0.001, 1e-5});
  const Solution solution = solve(ring.world.graph, {}, control);
  EXPECT_LT(ring.worst_m(solution), 0.1);
  ASSERT_TRUE(solution.control[0].after);
  EXPECT_LT(solution.control[0].after->norm(), 1e-3);
}

TEST(Control, LevelsAloneTurnUpAndLeavePlaceAndHeading) {
  MappedRing ring;
  // Every scan level but the frame of the anchor's solution: the ring as a whole is tilted by nothing else than noise.
  for (Transform& pose : ring.world.world_from_local) {
    const double heading = std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
    pose.linear() = rotation_from_vector({0, 0, heading});
  }
  ring.world.graph.links.clear();
  for (int i = 0; i < 8; ++i) ring.world.right((i + 1) % 8, i);
  Control control;
  for (int i = 1; i < 8; ++i) control.levelled.push_back({i, 1e-4});
  // One instrument stood askew.
  ring.world.graph.links.clear();
  Transform tilt = Transform::Identity();
  tilt.linear() = rotation_from_vector({0.1, 0, 0});
  ring.world.world_from_local[5] = ring.world.world_from_local[5] * tilt;
  for (int i = 0; i < 8; ++i) ring.world.right((i + 1) % 8, i);
  const Solution solution = solve(ring.world.graph, {}, control);
  const auto& world = solution.components[0].georeference;
  ASSERT_TRUE(world);
  EXPECT_TRUE(world->levelled_only);
  EXPECT_EQ(world->shift_m, Eigen::Vector3d(0, 0, 0));
  for (const PlacedScan& scan : solution.scans) {
    const Eigen::Matrix3d r = world->shifted_from_component.linear() * scan.component_from_local.linear();
    const Eigen::Matrix3d known = ring.world.world_from_local[static_cast<std::size_t>(scan.id)].linear();
    EXPECT_NEAR(r(2, 2), known(2, 2), 1e-4) << scan.id;
  }
  for (const ControlResult& r : solution.control) EXPECT_EQ(r.used, r.scan != 5) << r.scan << r.reason;
  EXPECT_NE(solution.control[4].reason.find("tilts by 5.7"), std::string::npos) << solution.control[4].reason;
}

TEST(Control, OfOtherPartsAndUnknownScansIsToldApart) {
  MappedRing ring;
  Control control = ring.points(4);
  control.points.push_back(control.points[0]);
  control.points.back().scan = 99;
  const Solution solution = solve(ring.world.graph, {}, control);
  EXPECT_FALSE(solution.control[4].used);
  EXPECT_EQ(solution.control[4].reason, "its scan takes no part");
  EXPECT_TRUE(solution.components[0].georeference);
}

}  // namespace
}  // namespace isthmus
