#include "regions/passers_by.h"

#include <gtest/gtest.h>

#include "pairwise/synthetic_product.h"

namespace isthmus {
namespace {

constexpr double kVoxelM = 0.12;

/// A room with one body in it, or on its wall, and what of the scan lies within the body's box.
struct Room {
  ScanProduct product;
  ScanModel model;
  std::vector<std::uint32_t> of_body;

  Room(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, const Transform& scan_from_world)
      : product(testing::product_of(seen(centre, size, scan_from_world), kVoxelM)),
        model(with_vertical(product, scan_from_world).sampled, product.features, product.regions, ModelLevel::coarse) {
    const Transform world_from_scan = scan_from_world.inverse();
    for (std::uint32_t i = 0; i < model.points.size(); ++i) {
      const Eigen::Vector3d off = world_from_scan * model.points[i].cast<double>() - centre;
      if ((off.cwiseAbs() - 0.5 * size).maxCoeff() < 0.03) of_body.push_back(i);
    }
  }
  [[nodiscard]] std::size_t counted() const { return num_of_passers_by(model, of_body); }

 private:
  /// A scanner that sees all round does not know its vertical.
  static ScanProduct& with_vertical(ScanProduct& product, const Transform& scan_from_world) {
    DominantAxis axis;
    axis.direction = scan_from_world.linear().col(2).cast<float>();
    axis.upright = true;
    product.features.axes = {axis};
    return product;
  }
  static testing::Points seen(const Eigen::Vector3d& centre, const Eigen::Vector3d& size,
                              const Transform& scan_from_world) {
    testing::Scene scene;
    scene.add_box({0, 0, 1.5}, {9, 7, 3});
    scene.add_box(centre, size);
    return testing::scan_scene(scene, scan_from_world.inverse(), {80000, 1e6, 0.003, 1});
  }
};

const Transform kUpright = testing::pose_of({0, 0, 1.6}).inverse();
const Eigen::Vector3d kPerson(0.5, 0.4, 1.75), kPlace(2, 0.8, 0.875);

TEST(PassersBy, APersonThatStandsFreeIsCounted) {
  const Room room(kPlace, kPerson, kUpright);
  ASSERT_GT(room.of_body.size(), 20U);
  EXPECT_EQ(room.counted(), room.of_body.size());
}

TEST(PassersBy, WhicheverWayTheScannerHeldItsHead) {
  const Room room(kPlace, kPerson, testing::pose_of({0, 0, 0}, {1.1, 0.4, -0.7}) * kUpright);
  ASSERT_GT(room.of_body.size(), 20U);
  EXPECT_EQ(room.counted(), room.of_body.size());
}

TEST(PassersBy, AFlatPieceOfAWallIsNobody) {
  const Room room({-4.5, 1, 1.2}, {0.3, 0.9, 1.8}, kUpright);
  ASSERT_GT(room.of_body.size(), 20U);
  EXPECT_EQ(room.counted(), 0U);
}

TEST(PassersBy, FurnitureIsNobody) {
  for (const Eigen::Vector3d& size : {Eigen::Vector3d(1.6, 0.8, 0.75), Eigen::Vector3d(2.4, 0.5, 1.9)}) {
    const Room room({2, 0.8, size.z() / 2}, size, kUpright);
    ASSERT_GT(room.of_body.size(), 20U);
    EXPECT_EQ(room.counted(), 0U) << size.transpose();
  }
}

TEST(PassersBy, WithoutAVerticalNobodyIsCounted) {
  Room room(kPlace, kPerson, kUpright);
  room.product.features.axes.front().upright = false;
  EXPECT_EQ(room.counted(), 0U);
}

TEST(PassersBy, WhereMuchIsContradictedPeopleAreNoExplanation) {
  const Room room(kPlace, kPerson, kUpright);
  const auto with_others = [&](double share) {
    std::vector<std::uint32_t> indices = room.of_body;
    for (std::uint32_t i = 0; i < room.model.points.size(); ++i)
      if (static_cast<double>(indices.size()) < share * static_cast<double>(room.model.points.size()) &&
          room.model.points[i].x() < -1)
        indices.push_back(i);
    return indices;
  };
  EXPECT_EQ(num_of_passers_by(room.model, with_others(0.14)), room.of_body.size());
  EXPECT_EQ(num_of_passers_by(room.model, with_others(0.16)), 0U);
  EXPECT_EQ(num_of_passers_by(room.model, {}), 0U);
}

}  // namespace
}  // namespace isthmus
