// A finished survey read back from its output folder: what exports to other programs need.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::report {

struct FinishedScan {
  int id = 0;        ///< vertex id
  std::string name;  ///< as in scans.csv
  int component = 0;
  Transform component_from_scan = Transform::Identity();
};

struct FinishedLink {
  int target = 0, source = 0;  ///< ids
  Transform target_from_source = Transform::Identity();
  Matrix6d information = Matrix6d::Zero();  ///< right perturbation, translation then rotation vector
};

struct FinishedSurvey {
  std::vector<FinishedScan> scans;  ///< placed ones, ascending ids
  std::vector<FinishedLink> links;  ///< accepted ones, in the order of the file

  [[nodiscard]] int num_components() const;
};

/// Reads poses.txt and pose_graph.g2o. Components are what the links join, numbered as in scans.csv: the largest is 0.
Result<FinishedSurvey> read_finished_survey(const std::filesystem::path& out);

}  // namespace isthmus::report
