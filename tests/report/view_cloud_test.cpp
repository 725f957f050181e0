#include "report/view_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "report/sample_record.h"
#include "report/view_script.h"
#include "report/view_section.h"

namespace isthmus::report {
namespace {

/// Reads what the page's script reads.
struct Decoded {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<int> intensity;
};

Decoded decoded(const ViewCloud& cloud) {
  Decoded out;
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(cloud.bytes.at(k)); };
  const std::size_t n = cloud.num_points;
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Vector3d p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = byte(6 * i + 2 * k) + 256.0 * byte(6 * i + 2 * k + 1);
    out.points.push_back(cloud.low + cloud.step_m * p);
    const double x = static_cast<std::int8_t>(byte(6 * n + 2 * i)) / 127.0,
                 y = static_cast<std::int8_t>(byte(6 * n + 2 * i + 1)) / 127.0;
    Eigen::Vector3d normal(x, y, 1 - std::abs(x) - std::abs(y));
    if (normal.z() < 0) {
      normal.x() = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
      normal.y() = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    }
    out.normals.push_back(normal.normalized());
    if (cloud.has_intensity) out.intensity.push_back(byte(8 * n + i));
  }
  return out;
}

SampledScan ball(std::size_t count) {
  SampledScan scan;
  scan.voxel_m = 0.1;
  Rng rng(5);
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3f n = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>();
    scan.points.push_back(10 * n);
    scan.normals.push_back(n);
    scan.variation.push_back(0);
  }
  return scan;
}

std::vector<float> rising(std::size_t count) {
  std::vector<float> out(count);
  std::iota(out.begin(), out.end(), 0.0f);
  return out;
}

TEST(ViewCloud, PointsAndNormalsComeBackInTheComponentsFrame) {
  const SampledScan scan = ball(3000);
  Rng rng(2);
  const Transform pose = isthmus::testing::random_pose(rng, 50);
  const ViewCloud cloud = view_cloud(scan, rising(3000), pose, 1000);
  ASSERT_EQ(cloud.num_points, 1000U);
  EXPECT_EQ(cloud.num_available, 3000U);
  EXPECT_EQ(cloud.bytes.size(), 9000U);
  const Decoded back = decoded(cloud);
  for (std::size_t k = 0; k < back.points.size(); ++k) {
    const Eigen::Vector3d from_middle = back.points[k] - pose.translation();
    EXPECT_NEAR(from_middle.norm(), 10, 1e-3);
    EXPECT_GT(from_middle.normalized().dot(back.normals[k]), 0.999);
  }
}

TEST(ViewCloud, AnyFirstPartIsAnEvenSample) {
  const Decoded back = decoded(view_cloud(ball(20000), {}, Transform::Identity(), 20000));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 2000; ++k) mean += back.points[k] / 2000;
  EXPECT_LT(mean.norm(), 0.6) << "2000 random points of a ball of 10 m have their mean within 0.4 m, seldom beyond";
}

TEST(ViewCloud, IntensityIsSpreadOverAByteAndLeftOutWhereThereIsNone) {
  const SampledScan scan = ball(1000);
  const Decoded back = decoded(view_cloud(scan, rising(1000), Transform::Identity(), 1000));
  EXPECT_EQ(*std::min_element(back.intensity.begin(), back.intensity.end()), 0);
  EXPECT_EQ(*std::max_element(back.intensity.begin(), back.intensity.end()), 255);
  const ViewCloud without = view_cloud(scan, {}, Transform::Identity(), 1000);
  EXPECT_FALSE(without.has_intensity);
  EXPECT_EQ(without.bytes.size(), 8000U);
}

TEST(ViewCloud, EmptyAndSinglePointsAreNoTrouble) {
  EXPECT_EQ(view_cloud(SampledScan{}, {}, Transform::Identity(), 10).num_points, 0U);
  const ViewCloud one = view_cloud(ball(1), {}, Transform::Identity(), 10);
  ASSERT_EQ(one.num_points, 1U);
  EXPECT_NEAR(decoded(one).points[0].norm(), 10, 1e-5);
}

TEST(ViewSection, HoldsEveryPlacedStationAndNothingEndsTheScriptEarly) {
  SurveyRecord record = isthmus::testing::sample_record(14);
  record.scans[0].name = "a</script>b.ply";
  record.scans[0].view = view_cloud(ball(100), rising(100), Transform::Identity(), 100);
  const std::string text = view_data(record);
  EXPECT_EQ(text.find("</"), std::string::npos);
  const auto json = nlohmann::json::parse(text);
  ASSERT_EQ(json["stations"].size(), 12U);
  EXPECT_EQ(json["stations"][0]["points"], 100);
  EXPECT_EQ(json["stations"][0]["data"].get<std::string>().size(), 1200U);
  EXPECT_EQ(json["links"].size(), record.solution.links.size());
  EXPECT_EQ(json["parts"].size(), 1U);
  const bool bundled = kViewScript[0] != '\0';
  EXPECT_EQ(view_section(record).empty(), !bundled);
  EXPECT_TRUE(view_section(isthmus::testing::sample_record(14)).empty()) << "no clouds, no view";
}

}  // namespace
}  // namespace isthmus::report
