// PCL's FPFH is the twin of ours.
#include <gtest/gtest.h>

#include <pcl/features/fpfh.h>
#include <pcl/point_types.h>
#include <numeric>

#include "features/fpfh.h"
#include "pairwise/synthetic_scene.h"

namespace isthmus {
namespace {

using Points = testing::Points;

std::vector<float> pcl_fpfh(const Points& points, const Points& normals, float radius_m) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  pcl::PointCloud<pcl::Normal>::Ptr cloud_normals(new pcl::PointCloud<pcl::Normal>);
  for (const auto& p : points) cloud->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
  for (const auto& n : normals) cloud_normals->push_back(pcl::Normal(n.x(), n.y(), n.z()));
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud_normals);
  estimation.setRadiusSearch(static_cast<double>(radius_m));
  pcl::PointCloud<pcl::FPFHSignature33> signatures;
  estimation.compute(signatures);
  std::vector<float> rows;
  for (const auto& s : signatures) rows.insert(rows.end(), std::begin(s.histogram), std::end(s.histogram));
  return rows;
}

void expect_twins(const Points& points, const Points& normals, float radius_m) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  const auto ours = fpfh(points, normals, all, all, radius_m);
  const auto twin = pcl_fpfh(points, normals, radius_m);
  ASSERT_EQ(ours.size(), twin.size());
  double sum = 0, largest = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const double d =
        std::abs(static_cast<double>(ours[k]) - static_cast<double>(twin[k]) / 100);  // PCL's blocks sum to 100
    sum += d;
    largest = std::max(largest, d);
  }
  EXPECT_LT(sum / static_cast<double>(points.size()) / 3, 1e-3) << "share of a block in another bin, on average";
  EXPECT_LT(largest, 0.05);
}

TEST(FpfhTwin, OnABumpySurface) {
  Rng rng(1);
  Points points, normals;
  for (int i = 0; i < 400; ++i) {
    const double x = rng.uniform(-1, 1), y = rng.uniform(-1, 1);
    points.push_back(Eigen::Vector3d(x, y, 0.3 * std::sin(4 * x) * std::cos(3 * y)).cast<float>());
    normals.push_back(
        Eigen::Vector3d(-1.2 * std::cos(4 * x) * std::cos(3 * y), 0.9 * std::sin(4 * x) * std::sin(3 * y), 1)
            .normalized()
            .cast<float>());
  }
  expect_twins(points, normals, 0.3f);
  expect_twins(points, normals, 0.6f);
}

TEST(FpfhTwin, OnRandomPointsAndNormals) {
  Rng rng(2);
  Points points, normals;
  for (int i = 0; i < 300; ++i) {
    points.push_back(Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).cast<float>());
    normals.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>());
  }
  expect_twins(points, normals, 0.5f);
}

}  // namespace
}  // namespace isthmus
