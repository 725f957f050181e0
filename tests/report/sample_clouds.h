// Clouds for the made-up survey: at each station some paving, house fronts and a tree.
#pragma once

#include <cmath>
#include <vector>

#include "report/sample_record.h"

namespace isthmus::testing {

struct SampleCloud {
  SampledScan scan;
  std::vector<float> intensity;
};

inline SampleCloud sample_cloud(int id, std::size_t num_points) {
  SampleCloud out;
  SampledScan& scan = out.scan;
  scan.voxel_m = 0.1;
  Rng rng(static_cast<std::uint64_t>(id) + 1);
  const double width = rng.uniform(7, 11), height = rng.uniform(5, 12);
  const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n, double intensity) {
    scan.points.push_back(p.cast<float>());
    scan.normals.push_back(n.normalized().cast<float>());
    scan.variation.push_back(0);
    out.intensity.push_back(static_cast<float>(intensity));
  };
  for (std::size_t k = 0; k < num_points; ++k) {
    const double kind = rng.uniform(), u = rng.uniform(-15, 15);
    if (kind < 0.4) {
      const double v = rng.uniform(-width, width);
      add({u, v, -1.7}, {0, 0, 1}, std::fmod(std::floor(u) + std::floor(v) + 60, 2.0) < 1 ? 0.3 : 0.4);
    } else if (kind < 0.9) {
      const double side = rng.uniform() < 0.5 ? -1 : 1, z = rng.uniform(0, height);
      const bool window = std::fmod(u + 20, 3) < 1.2 && std::fmod(z + 2, 3) < 1.5;
      add({u, side * (width + (window ? 0.2 : 0.0)), z - 1.7}, {0, -side, 0}, window ? 0.1 : 0.7);
    } else {
      const Eigen::Vector3d n = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
      add(Eigen::Vector3d(6, 4, 2.5) + 2 * std::sqrt(rng.uniform()) * n, n, 0.5 + 0.1 * rng.normal());
    }
  }
  return out;
}

inline void add_sample_clouds(report::SurveyRecord& record, std::size_t points_each) {
  for (report::ScanRecord& scan : record.scans) {
    const PlacedScan* placed = record.solution.find(scan.id);
    if (placed == nullptr || scan.status != report::ScanStatus::placed) continue;
    const SampleCloud cloud = sample_cloud(scan.id, points_each);
    scan.view = report::view_cloud(cloud.scan, cloud.intensity, placed->component_from_local, points_each);
  }
}

}  // namespace isthmus::testing
