// Primitives, rays, paths and terrain.
#include "simulate/mesh.h"

#include <gtest/gtest.h>

#include <numbers>

#include "simulate/path.h"
#include "simulate/ray_scene.h"
#include "simulate/terrain.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// Positive when every triangle is counter-clockwise seen from outside (divergence theorem).
double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>();
    sum += a.dot(b.cross(mesh.vertices[t[2]].cast<double>())) / 6;
  }
  return sum;
}

const Transform kSomewhere = upright({3, -2, 1}, 0.7);

TEST(MeshPrimitives, EnclosePositiveVolumes) {
  Mesh box, frustum, ball;
  add_box(box, kSomewhere, {0, 0, 0}, {2, 3, 4}, Material::wood);
  EXPECT_NEAR(volume_of(box), 24, 1e-4);
  add_frustum(frustum, {1, 1, 0}, {1, 3, 4}, 0.5, 0.5, 64, Material::wood);
  EXPECT_NEAR(volume_of(frustum), kPi * 0.25 * std::sqrt(20.0), 0.02);
  add_ellipsoid(ball, kSomewhere, {1, 2, 3}, 40, 80, Material::wood);
  EXPECT_NEAR(volume_of(ball), 4.0 / 3 * kPi * 6, 0.1);
}

TEST(MeshPrimitives, OneMaterialPerTriangle) {
  Mesh mesh;
  add_box(mesh, kSomewhere, {0, 0, 0}, {1, 1, 1}, Material::wood);
  add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, Material::glass);
  add_wall(mesh, kSomewhere, 5, 3, 0.2, {{1, 2, 0, 2}, {3, 4, 1, 2}}, Material::brick);
  EXPECT_EQ(mesh.materials.size(), mesh.triangles.size());
}

TEST(Wall, RaysPassThroughOpeningsAndMeetTheRest) {
  Mesh mesh;
  // Unsorted openings: a window at x 3..4, z 1..2, a door at x 1..2 from the floor to 2 m.
  add_wall(mesh, upright({0, 10, 0}, 0), 5, 3, 0.2, {{3, 4, 1, 2}, {1, 2, 0, 2}}, Material::brick);
  const Result<RayScene> scene = RayScene::build(std::move(mesh));
  ASSERT_TRUE(scene);
  const auto range_at = [&](double x, double z) {
    const auto hit = scene->trace({x, 0, z}, Vector3d::UnitY(), 0, 100);
    return hit ? hit->range_m : -1.0;
  };
  EXPECT_EQ(range_at(1.5, 1.0), -1);
  EXPECT_EQ(range_at(3.5, 1.5), -1);
  EXPECT_NEAR(range_at(1.5, 2.5), 10, 1e-9);
  EXPECT_NEAR(range_at(3.5, 0.5), 10, 1e-9);
  EXPECT_NEAR(range_at(2.5, 1.5), 10, 1e-9);
  EXPECT_EQ(range_at(5.5, 1.5), -1);
}

TEST(RayScene, EmptyMeshIsNeverHit) {
  const Result<RayScene> scene = RayScene::build({});
  ASSERT_TRUE(scene);
  EXPECT_FALSE(scene->trace({0, 0, 0}, Vector3d::UnitX(), 0, 1000));
}

TEST(RayScene, RangesAreExactToDoubleOnASlantedTriangle) {
  Mesh mesh;
  add_triangle(mesh, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, Material::wood);  // x + y + z = 1
  const Result<RayScene> scene = RayScene::build(std::move(mesh));
  ASSERT_TRUE(scene);
  const Vector3d from(-3, -2, -2.5), direction = Vector3d(0.9, 0.65, 0.81).normalized();
  const auto hit = scene->trace(from, direction, 0, 100);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range_m, (1 - from.sum()) / direction.sum(), 1e-12);
  EXPECT_NEAR(hit->normal.dot(Vector3d(1, 1, 1).normalized()), 1, 1e-7);
}

TEST(RayScene, PacketAgreesWithSingleRays) {
  Mesh mesh;
  add_ellipsoid(mesh, upright({5, 0, 0}, 0.3), {1, 2, 1.5}, 12, 20, Material::wood);
  const Result<RayScene> scene = RayScene::build(std::move(mesh));
  ASSERT_TRUE(scene);
  Packet packet;
  packet.count = kPacket - 1;
  std::array<Vector3d, kPacket> directions;
  for (int k = 0; k < packet.count; ++k) {
    directions[k] = Vector3d(1, -0.6 + 0.17 * k, 0.05 * k).normalized();
    packet.x[k] = static_cast<float>(directions[k].x());
    packet.y[k] = static_cast<float>(directions[k].y());
    packet.z[k] = static_cast<float>(directions[k].z());
  }
  std::array<RawHit, kPacket> hits;
  scene->trace(Vector3d::Zero(), packet, 100, hits);
  int num_hits = 0;
  for (int k = 0; k < packet.count; ++k) {
    const auto single = scene->trace(Vector3d::Zero(), directions[k], 0, 100);
    ASSERT_EQ(single.has_value(), hits[k].triangle != RawHit::kNone) << k;
    if (!single) continue;
    ++num_hits;
    EXPECT_NEAR(scene->resolve(Vector3d::Zero(), directions[k], hits[k]).range_m, single->range_m, 1e-6);
  }
  EXPECT_GT(num_hits, 3);
  EXPECT_LT(num_hits, packet.count);
}

TEST(Path, AroundABlockComesBack) {
  Rng rng(4);
  const Path path = around_a_block(400, 16, rng);
  EXPECT_LT((path.at(0) - path.at(400)).norm(), 0.02);
  EXPECT_NEAR(path.heading_rad(400) - path.heading_rad(0), 2 * kPi, 1e-9);
}

TEST(Path, OffsetsAreSquareToTheAxis) {
  Rng rng(4);
  const Path path = winding_path(300, 80, rng);
  for (const double s : {-20.0, 10.0, 150.0, 310.0}) {
    const Vector2d along = path.at(s + 0.01) - path.at(s - 0.01), across = path.at(s, 5) - path.at(s);
    EXPECT_NEAR(across.norm(), 5, 1e-9);
    EXPECT_NEAR(along.normalized().dot(across.normalized()), 0, 0.01) << s;
  }
}

TEST(Terrain, GroundMeshFollowsTheHeight) {
  Rng rng(9);
  const Terrain terrain(0.05, 1.5, 40, 3, rng);
  Mesh mesh;
  add_ground(mesh, terrain, {-10, -5}, {10, 15}, 0.5, 0, Material::soil, rng);
  const Result<RayScene> scene = RayScene::build(std::move(mesh));
  ASSERT_TRUE(scene);
  for (int k = 0; k < 50; ++k) {
    const double x = rng.uniform(-9, 9), y = rng.uniform(-4, 14);
    const auto hit = scene->trace({x, y, 20}, -Vector3d::UnitZ(), 0, 100);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(20 - hit->range_m, terrain.height_m(x, y), 0.05);
    EXPECT_GT(hit->normal.z(), 0.5);
  }
}

}  // namespace
}  // namespace isthmus::sim
