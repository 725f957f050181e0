// Control as a person writes it, in YAML or CSV, and its scans found in a survey. The form: docs/stages/control.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/measured_survey.h"
#include "survey/control.h"

namespace isthmus::pipelines {

/// One item of a control file; scans by the names that a person gives them.
struct ControlItem {
  ControlKind kind = ControlKind::point;
  std::string where;  ///< "control.yaml:3:5", "control.csv:4"
  std::string name;
  std::string scan;                          ///< levelled: may hold * and ?
  std::optional<Eigen::Vector3d> p_in_scan;  ///< point; absent: the scan's station
  Eigen::Vector3d p_in_world = Eigen::Vector3d::Zero();
  Transform world_from_scan = Transform::Identity();  ///< pose
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Zero();
  double sigma_rad = 0;
};

/// YAML unless the file's extension is .csv. Errors name line, key and value.
Result<std::vector<ControlItem>> read_control(const std::filesystem::path& file);

/// Between local frames of the survey's scans. Fails on unknown scans, and on stations whose place is not known.
Result<Control> control_of(const std::vector<ControlItem>& items, const MeasuredSurvey& survey);

}  // namespace isthmus::pipelines
