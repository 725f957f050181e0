// A tiny survey on disk: three rooms' worth of points, truth, and outputs with known errors.
#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/rng.h"
#include "geometry/transform.h"

namespace isthmus::testing {

inline constexpr double kEvaluationVoxel = 0.2;

inline std::string pose_words(const Transform& t) {
  std::string out;
  for (int k = 0; k < 12; ++k) out += fmt::format(" {}", t(k / 4, k % 4));
  return out;
}

inline std::string g2o_words(const Transform& t) {
  const Eigen::Quaterniond q(t.linear());
  return fmt::format("{} {} {} {} {} {} {}", t.translation().x(), t.translation().y(), t.translation().z(), q.x(),
                     q.y(), q.z(), q.w());
}

/// Stations along the x axis, each sees a stretch of ground and a wall; neighbours overlap.
class MadeSurvey {
 public:
  std::filesystem::path scans, out;
  std::vector<Transform> common_from_scan;
  std::vector<std::string> names;

  MadeSurvey(const std::string& name, int num_scans) {
    const std::filesystem::path root = std::filesystem::path(::testing::TempDir()) / ("isthmus_" + name);
    std::filesystem::remove_all(root);
    scans = root / "scans", out = root / "out";
    std::filesystem::create_directories(scans);
    std::filesystem::create_directories(out);
    Rng rng(31);
    std::ofstream truth(scans / "poses.gt.txt");
    for (int i = 0; i < num_scans; ++i) {
      Transform pose = Transform::Identity();
      pose.linear() = rotation_from_vector({0, 0, rng.uniform(-3, 3)});
      pose.translation() = Eigen::Vector3d(4.0 * i, 0, 1.5);
      common_from_scan.push_back(pose);
      names.push_back(fmt::format("scan {}.ply", i));
      for (char& c : names.back()) c = c == ' ' ? '_' : c;
      write_scan(i, rng);
      truth << names[i] << pose_words(pose) << '\n';
    }
  }
  [[nodiscard]] Transform truth_of(int target, int source) const {
    return common_from_scan[target].inverse() * common_from_scan[source];
  }

  /// Outputs: edges (target, source, measurement) and poses in the frame of scan 0.
  struct Edge {
    int target, source;
    Transform target_from_source;
  };
  void write_outputs(const std::vector<Edge>& edges, const std::vector<std::pair<int, Transform>>& poses,
                     const std::vector<int>& component) const {
    std::ofstream table(out / "scans.csv"), g2o(out / "pose_graph.g2o"), text(out / "poses.txt");
    table << "id,name,status,component,points,voxel_m\n";
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool placed = component[i] >= 0;
      table << i << ",\"sub/" << names[i] << "\"," << (placed ? "placed," : "failed,")
            << (placed ? std::to_string(component[i]) : "") << ",10," << kEvaluationVoxel << '\n';
    }
    for (const Edge& e : edges)
      g2o << "EDGE_SE3:QUAT " << e.target << ' ' << e.source << ' ' << g2o_words(e.target_from_source) << " 1\n";
    for (const auto& [i, pose] : poses) text << "sub/" << names[i] << pose_words(pose) << '\n';
  }

 private:
  void write_scan(int i, Rng& rng) const {
    std::vector<float> xyz;
    const auto add = [&](double x, double y, double z) {
      const Eigen::Vector3d p = common_from_scan[i].inverse() * Eigen::Vector3d(x, y, z);
      for (int k = 0; k < 3; ++k) xyz.push_back(static_cast<float>(p[k]));
    };
    const double x0 = 4.0 * i;
    for (int k = 0; k < 6000; ++k) add(x0 + rng.uniform(-5, 5), rng.uniform(-3, 3), rng.uniform(-0.01, 0.01));
    for (int k = 0; k < 4000; ++k) add(x0 + rng.uniform(-5, 5), 3 + rng.uniform(-0.01, 0.01), rng.uniform(0, 4));
    std::ofstream file(scans / names[i], std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << xyz.size() / 3
         << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    file.write(reinterpret_cast<const char*>(xyz.data()), static_cast<std::streamsize>(xyz.size() * sizeof(float)));
  }
};

inline Transform shifted(Transform t, double x) {
  t.translation().x() += x;
  return t;
}

}  // namespace isthmus::testing
