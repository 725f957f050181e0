// The scanner model in a box room whose ranges one can work out by hand.
#include "simulate/scanner.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/rng.h"

namespace isthmus::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
const Vector3d kLow(-4, -3, 0), kHigh(6, 5, 3);  // the room, common frame

ScannerModel quiet(double step_deg) {
  ScannerModel m;
  m.step_rad = step_deg * kRadPerDeg;
  m.noise_m = m.noise_per_m = m.beam_rad = m.dropouts = 0;
  m.signal_loss = false;
  m.min_range_m = 0;
  return m;
}

RayScene room_with(Mesh mesh, Material walls = Material::plaster) {
  add_box(mesh, Transform::Identity(), kLow, kHigh, walls);
  return std::move(*RayScene::build(std::move(mesh)));
}

/// Distance from inside the room to its walls along a direction: the slab formula.
double range_to_walls(const Vector3d& from, const Vector3d& direction) {
  double range = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    range = std::min(range, ((direction[k] > 0 ? kHigh : kLow)[k] - from[k]) / direction[k]);
  }
  return range;
}

Station station_at(const Vector3d& centre, const Vector3d& rotation_vector, std::uint64_t seed = 1) {
  Station s;
  s.common_from_instrument.linear() = rotation_from_vector(rotation_vector);
  s.common_from_instrument.translation() = centre;
  s.seed = seed;
  return s;
}

TEST(Grid, CoversAFullTurnAndAllButTheTripod) {
  EXPECT_EQ(grid_of(0.1 * kRadPerDeg).columns, 3600);
  EXPECT_EQ(grid_of(0.1 * kRadPerDeg).rows, 1501);
  EXPECT_EQ(grid_of(1 * kRadPerDeg).rows, 151);
}

TEST(Scanner, RangesToWallsAreThoseOfTheSlabFormula) {
  const RayScene room = room_with({});
  const Station station = station_at({0.5, 1, 1.7}, {0.02, -0.1, 2.3});
  const io::PointChunk scan = scan_from(station, {&room, nullptr}, quiet(2));
  const Grid grid = grid_of(2 * kRadPerDeg);
  ASSERT_EQ(scan.points.size(), static_cast<std::size_t>(grid.rows) * grid.columns);
  ASSERT_EQ(scan.intensity.size(), scan.points.size());
  for (const Eigen::Vector3f& p : scan.points) {
    const Vector3d direction = station.common_from_instrument.linear() * p.cast<double>().normalized();
    const double expected = range_to_walls(station.common_from_instrument.translation(), direction);
    EXPECT_NEAR(p.cast<double>().norm(), expected, 1e-5);
  }
}

TEST(Scanner, FirstRowLooksUpAndTheLastSixtyDegreesDown) {
  const RayScene room = room_with({});
  const io::PointChunk scan = scan_from(station_at({0, 0, 1.5}, {0, 0, 0}), {&room, nullptr}, quiet(5));
  EXPECT_NEAR(scan.points.front().z(), 1.5, 1e-5);
  EXPECT_NEAR(scan.points.front().head<2>().norm(), 0, 1e-5);
  EXPECT_NEAR(scan.points.back().normalized().z(), -std::sin(60 * kRadPerDeg), 1e-5);
}

TEST(Scanner, TurnedCoordinatesAreTheSamePointsTurned) {
  const RayScene room = room_with({});
  Station straight = station_at({0, 0, 1.5}, {0, 0, 1}), turned = straight;
  turned.scan_from_instrument.linear() = rotation_from_vector({1.1, -2, 0.4});
  const io::PointChunk a = scan_from(straight, {&room, nullptr}, quiet(5)),
                       b = scan_from(turned, {&room, nullptr}, quiet(5));
  ASSERT_EQ(a.points.size(), b.points.size());
  const Eigen::Matrix3f turn = turned.scan_from_instrument.linear().cast<float>();
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_LT((turn * a.points[i] - b.points[i]).norm(), 1e-5);
}

TEST(Scanner, RangeNoiseHasTheStatedSigma) {
  const RayScene room = room_with({});
  ScannerModel model = quiet(2);
  model.noise_m = 0.003;
  model.noise_per_m = 0.001;
  const Station station = station_at({1, 1, 1.5}, {0, 0, 0});
  double sum = 0, sum_sq = 0;
  const io::PointChunk scan = scan_from(station, {&room, nullptr}, model);
  for (const Eigen::Vector3f& p : scan.points) {
    const Vector3d q = p.cast<double>();
    const double truth = range_to_walls({1, 1, 1.5}, q.normalized()), z = (q.norm() - truth) / (0.003 + 0.001 * truth);
    sum += z;
    sum_sq += z * z;
  }
  const auto n = static_cast<double>(scan.points.size());
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(sum_sq / n, 1, 0.05);
}

/// A post at x = 2 before the wall at x = 6: edges with a gap of 1 m after moving the wall's twin near.
RayScene room_with_step() {
  Mesh mesh;
  add_box(mesh, Transform::Identity(), {2, -0.5, 0}, {2.1, 0.5, 3}, Material::wood);
  add_box(mesh, Transform::Identity(), {3, -2.5, 0}, {3.1, 4.5, 3}, Material::wood);
  return room_with(std::move(mesh));
}

/// Points strictly between the two surfaces x = 2 and x = 3 on the far side of the post.
int points_between(const io::PointChunk& scan) {
  int count = 0;
  for (const Eigen::Vector3f& p : scan.points) {
    count += p.x() > 2.15F && p.x() < 2.95F && std::abs(p.y()) < 1 && p.z() > -1.2F && p.z() < 1.2F;
  }
  return count;
}

TEST(Scanner, MixedPixelsLieBetweenTheSurfacesOfAnEdge) {
  const RayScene room = room_with_step();
  ScannerModel model = quiet(0.5);
  const Station station = station_at({0, 0, 1.5}, {0, 0, 0});
  EXPECT_EQ(points_between(scan_from(station, {&room, nullptr}, model)), 0);
  model.beam_rad = 0.5 * kRadPerDeg;  // as wide as the grid: every edge is straddled
  const int mixed = points_between(scan_from(station, {&room, nullptr}, model));
  EXPECT_GT(mixed, 20);
  model.beam_rad = 0.1 * kRadPerDeg;
  const int fewer = points_between(scan_from(station, {&room, nullptr}, model));
  EXPECT_GT(fewer, 0);
  EXPECT_LT(fewer, mixed / 2);
}

TEST(Scanner, DropoutsThinOutEvenly) {
  const RayScene room = room_with({});
  ScannerModel model = quiet(2);
  model.dropouts = 0.25;
  const Grid grid = grid_of(model.step_rad);
  const io::PointChunk scan = scan_from(station_at({0, 0, 1.5}, {0, 0, 0}), {&room, nullptr}, model);
  EXPECT_NEAR(static_cast<double>(scan.points.size()) / (grid.rows * grid.columns), 0.75, 0.02);
}

TEST(Scanner, DarkAndDistantWallsLoseReturns) {
  const RayScene bright = room_with({}, Material::plaster), dark = room_with({}, Material::screen);
  const Station station = station_at({0, 0, 1.5}, {0, 0, 0});
  const auto kept_share = [&](const RayScene& room, double max_range_m) {
    ScannerModel model = quiet(2);
    model.max_range_m = max_range_m;
    const auto all = static_cast<double>(scan_from(station, {&room, nullptr}, model).points.size());
    model.signal_loss = true;
    return static_cast<double>(scan_from(station, {&room, nullptr}, model).points.size()) / all;
  };
  EXPECT_GT(kept_share(bright, 7), 0.98);
  EXPECT_LT(kept_share(dark, 7), 0.85);
  EXPECT_GT(kept_share(dark, 100), 0.98);
}

TEST(Scanner, NoReturnsAreKeptAtTheOriginOnlyWhenAsked) {
  const RayScene nothing = std::move(*RayScene::build({}));
  ScannerModel model = quiet(5);
  const Station station = station_at({0, 0, 1.5}, {0, 0, 0});
  EXPECT_TRUE(scan_from(station, {&nothing, nullptr}, model).points.empty());
  model.keep_no_return = true;
  const io::PointChunk scan = scan_from(station, {&nothing, nullptr}, model);
  const Grid grid = grid_of(model.step_rad);
  ASSERT_EQ(scan.points.size(), static_cast<std::size_t>(grid.rows) * grid.columns);
  for (const Eigen::Vector3f& p : scan.points) EXPECT_EQ(p.norm(), 0);
}

TEST(Scanner, RangeLimitsCutBothEnds) {
  const RayScene room = room_with({});
  ScannerModel model = quiet(2);
  model.min_range_m = 2;
  model.max_range_m = 5;
  for (const Eigen::Vector3f& p : scan_from(station_at({0, 0, 1.5}, {0, 0, 0}), {&room, nullptr}, model).points) {
    EXPECT_GT(p.norm(), 2 - 1e-5);
    EXPECT_LT(p.norm(), 5 + 1e-5);
  }
}

TEST(Scanner, GlassPassesMirrorsOrSwallows) {
  Mesh pane;  // across the whole room at y = 2; the station's own wall is at y = -3, so its mirror image at y = 7
  add_quad(pane, {-4, 2, 0}, {6, 2, 0}, {6, 2, 3}, {-4, 2, 3}, Material::glass);
  const RayScene room = room_with(std::move(pane));
  const Station station = station_at({0, 0, 1.5}, {0, 0, 0});
  ScannerModel model = quiet(0.5);
  int through = 0, ghosts = 0, on_pane = 0, on_floor_or_ceiling = 0, all = 0;
  const io::PointChunk scan = scan_from(station, {&room, nullptr}, model);
  for (const Eigen::Vector3f& p : scan.points) {
    const Vector3d d = p.cast<double>().normalized();
    if (d.y() < 0.9) continue;  // a cone towards the pane
    ++all;
    through += std::abs(p.y() - 5) < 1e-3;
    ghosts += std::abs(p.y() - 7) < 1e-3;
    on_pane += std::abs(p.y() - 2) < 1e-3;
    on_floor_or_ceiling += std::abs(std::abs(p.z()) - 1.5) < 1e-3;
  }
  EXPECT_GT(through, 0.4 * all);
  EXPECT_GT(ghosts, 0.02 * all);
  EXPECT_GT(on_pane, 0);
  EXPECT_GT(through + ghosts + on_pane + on_floor_or_ceiling, 0.98 * all);
  model.glass = false;
  for (const Eigen::Vector3f& p : scan_from(station, {&room, nullptr}, model).points) {
    const bool flat = std::abs(p.z()) > 1.49F;
    EXPECT_TRUE(flat || std::abs(p.y() - 2) > 1e-3);
  }
}

TEST(Scanner, MovingThingsHideWhatIsBehindThem) {
  const RayScene room = room_with({});
  Mesh box;
  add_box(box, Transform::Identity(), {2, -0.5, 0}, {2.5, 0.5, 2}, Material::cloth_dark);
  const RayScene moving = std::move(*RayScene::build(std::move(box)));
  const io::PointChunk scan = scan_from(station_at({0, 0, 1.5}, {0, 0, 0}), {&room, &moving}, quiet(1));
  int on_front = 0;
  for (const Eigen::Vector3f& p : scan.points) {
    on_front += std::abs(p.x() - 2) < 1e-4F && std::abs(p.y()) < 0.5F && p.z() < 0.5F;
    EXPECT_FALSE(p.x() > 3 && std::abs(p.y()) < 0.6F && std::abs(p.z()) < 0.1F);
  }
  EXPECT_GT(on_front, 200);
}

TEST(Scanner, SamePointsForOneAndTwoThreads) {
  const RayScene room = room_with_step();
  ScannerModel model;
  model.step_rad = 0.5 * kRadPerDeg;
  const Station station = station_at({0, 0, 1.5}, {0, 0, 0.3}, 77);
  const auto with_threads = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return scan_from(station, {&room, nullptr}, model); });
  };
  const io::PointChunk one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.intensity, two.intensity);
}

}  // namespace
}  // namespace isthmus::sim
