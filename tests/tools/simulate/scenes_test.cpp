// Every kind of place: built from the seed, with free stations that see enough.
#include "simulate/scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "simulate/movers.h"
#include "simulate/scanner.h"
#include "simulate/stations.h"

namespace isthmus::sim {
namespace {

struct Built {
  Scene scene;
  RayScene solids;
  std::vector<Vector3d> stations;
};

Built built(const std::string& kind, int num_stations, std::uint64_t seed) {
  Scene scene = build_scene(kind, {num_stations, default_spacing_m(kind), seed});
  RayScene solids = std::move(*RayScene::build(std::move(scene.mesh)));
  auto stations = settle_stations(solids, scene.stations);
  EXPECT_TRUE(stations) << stations.error().text();
  return {std::move(scene), std::move(solids), stations.value_or(std::vector<Vector3d>{})};
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, PlacesItsStationsApartAndOutsideSolids) {
  for (const std::uint64_t seed : {1, 2}) {
    for (const int n : {1, 9, 26}) {
      const Built b = built(GetParam(), n, seed);
      ASSERT_EQ(b.stations.size(), static_cast<std::size_t>(n));
      for (std::size_t i = 0; i < b.stations.size(); ++i) {
        EXPECT_TRUE(is_free(b.solids, b.stations[i], 0.5)) << i;
        const auto height = height_above_ground_m(b.solids, b.stations[i], 5);
        ASSERT_TRUE(height);
        EXPECT_GT(*height, 0.6);
        EXPECT_LT(*height, 2.8);
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT((b.stations[i] - b.stations[j]).norm(), 1.5) << i << " " << j;
      }
    }
  }
}

TEST_P(EveryScene, SendsMostRaysBelowTheHorizonBack) {
  ScannerModel model;
  model.step_rad = 1.0 * 3.14159265358979 / 180;
  for (const std::uint64_t seed : {1, 2}) {
    const Built b = built(GetParam(), 4, seed);
    for (const Vector3d& centre : b.stations) {
      const Station station{upright(centre, 0.4), Transform::Identity(), seed};
      const io::PointChunk scan = scan_from(station, {&b.solids, nullptr}, model);
      const auto below = std::ranges::count_if(scan.points, [](const Eigen::Vector3f& p) { return p.z() < 0; });
      EXPECT_GT(static_cast<double>(below), 0.85 * 60 * 360);
    }
  }
}

TEST_P(EveryScene, OtherSeedOtherPlace) {
  const Scene a = build_scene(GetParam(), {4, default_spacing_m(GetParam()), 1});
  const Scene b = build_scene(GetParam(), {4, default_spacing_m(GetParam()), 2});
  const Scene again = build_scene(GetParam(), {4, default_spacing_m(GetParam()), 1});
  EXPECT_NE(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.vertices, again.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, again.mesh.triangles);
  EXPECT_EQ(a.stations, again.stations);
}

TEST_P(EveryScene, PeopleStandOnTheGroundAndKeepClearOfTheTripod) {
  const Built b = built(GetParam(), 3, 5);
  Scene crowded = Scene{{}, {}, b.scene.lanes, 20};
  int num_movers = 0;
  for (const Vector3d& centre : b.stations) {
    Rng rng(3), other(4);
    const Mesh mesh = movers_around(centre, crowded, b.solids, rng);
    num_movers += !mesh.triangles.empty();
    EXPECT_NE(mesh.vertices, movers_around(centre, crowded, b.solids, other).vertices);
    for (const Eigen::Vector3f& v : mesh.vertices) {
      EXPECT_GT((v.cast<double>() - centre).head<2>().norm(), 0.5);
    }
  }
  EXPECT_GT(num_movers, 0);
}

INSTANTIATE_TEST_SUITE_P(Simulate, EveryScene, testing::ValuesIn(scene_names()),
                         [](const auto& scene) { return scene.param; });

TEST(Stations, InsideASolidIsNotFree) {
  Mesh mesh;
  add_box(mesh, Transform::Identity(), {-50, -50, -1}, {50, 50, 0}, Material::soil);
  add_box(mesh, Transform::Identity(), {0, 0, 0}, {6, 6, 4}, Material::brick);
  const RayScene scene = std::move(*RayScene::build(std::move(mesh)));
  EXPECT_FALSE(is_free(scene, {3, 3, 1.7}, 0.5));
  EXPECT_FALSE(is_free(scene, {-0.3, 3, 1.7}, 0.5));
  EXPECT_TRUE(is_free(scene, {-2, 3, 1.7}, 0.5));
}

TEST(Stations, MoveAsideOrSayThatThereIsNoRoom) {
  Mesh mesh;
  add_box(mesh, Transform::Identity(), {-50, -50, -1}, {50, 50, 0}, Material::soil);
  add_box(mesh, Transform::Identity(), {0, 0, 0}, {1, 1, 4}, Material::brick);
  add_box(mesh, Transform::Identity(), {20, 20, 0}, {40, 40, 4}, Material::brick);
  const RayScene scene = std::move(*RayScene::build(std::move(mesh)));
  const auto moved = settle_stations(scene, {{0.5, 0.5, 1.7}});
  ASSERT_TRUE(moved);
  EXPECT_TRUE(is_free(scene, moved->front(), 0.5));
  EXPECT_LT((moved->front() - Vector3d(0.5, 0.5, 1.7)).norm(), 2);
  const auto stuck = settle_stations(scene, {{5, 5, 1.7}, {30, 30, 1.7}});
  ASSERT_FALSE(stuck);
  EXPECT_NE(stuck.error().text().find("station 1"), std::string::npos) << stuck.error().text();
}

}  // namespace
}  // namespace isthmus::sim
