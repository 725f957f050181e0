#include "report/pose_exports.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "report/csv.h"

namespace isthmus::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, PoseFormat>, 6> kNames = {{
    {"open3d", PoseFormat::open3d},
    {"tum", PoseFormat::tum},
    {"kitti", PoseFormat::kitti},
    {"csv", PoseFormat::csv},
    {"3dtk", PoseFormat::dtk},
    {"riscan", PoseFormat::riscan},
}};

std::vector<FinishedScan> scans_of(const FinishedSurvey& survey, int component) {
  std::vector<FinishedScan> scans;
  for (const FinishedScan& scan : survey.scans) {
    if (scan.component == component) scans.push_back(scan);
  }
  return scans;
}

void append(std::string& out, double value) { fmt::format_to(std::back_inserter(out), " {}", value + 0.0); }

std::string tum(const std::vector<FinishedScan>& scans) {
  std::string out;
  for (const FinishedScan& scan : scans) {
    Eigen::Quaterniond q = Eigen::Quaterniond(scan.component_from_scan.linear()).normalized();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    out += fmt::format("{}", scan.id);
    for (int k = 0; k < 3; ++k) append(out, scan.component_from_scan.translation()[k]);
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) append(out, value);
    out += '\n';
  }
  return out;
}

std::string kitti(const std::vector<FinishedScan>& scans) {
  std::string out;
  for (const FinishedScan& scan : scans) {
    std::string line;
    for (int k = 0; k < 12; ++k) append(line, scan.component_from_scan(k / 4, k % 4));
    out += line.substr(1) + '\n';
  }
  return out;
}

std::string csv(const std::vector<FinishedScan>& scans) {
  CsvTable table;
  table.add("name");
  for (int k = 0; k < 16; ++k) table.add(fmt::format("m{}{}", k / 4, k % 4));
  table.end_row();
  for (const FinishedScan& scan : scans) {
    table.add(scan.name);
    const Eigen::Matrix4d m = scan.component_from_scan.matrix();
    for (int k = 0; k < 16; ++k) table.add_exact(m(k / 4, k % 4) + 0.0);
    table.end_row();
  }
  return table.text();
}

/// Column by column, as Open3D stores all its matrices.
template <class Matrix>
Json columns(const Matrix& m) {
  Json all = Json::array();
  for (Eigen::Index column = 0; column < m.cols(); ++column) {
    for (Eigen::Index row = 0; row < m.rows(); ++row) all.push_back(m(row, column) + 0.0);
  }
  return all;
}

Json versioned(const char* class_name) {
  return {{"class_name", class_name}, {"version_major", 1}, {"version_minor", 0}};
}

// Open3D's error vector is rotation first: (angles, translation) of transformation^-1 * T_target^-1 * T_source.
Matrix6d rotation_first(const Matrix6d& m) {
  Matrix6d out;
  out << m.bottomRightCorner<3, 3>(), m.bottomLeftCorner<3, 3>(), m.topRightCorner<3, 3>(), m.topLeftCorner<3, 3>();
  return out;
}

std::string open3d(const FinishedSurvey& survey, const std::vector<FinishedScan>& scans) {
  std::map<int, std::size_t> node_of;
  Json nodes = Json::array(), edges = Json::array();
  for (const FinishedScan& scan : scans) {
    node_of.emplace(scan.id, node_of.size());
    Json node = versioned("PoseGraphNode");
    node["pose"] = columns(scan.component_from_scan.matrix());
    nodes.push_back(std::move(node));
  }
  for (const FinishedLink& link : survey.links) {
    const auto source = node_of.find(link.source), target = node_of.find(link.target);
    if (source == node_of.end() || target == node_of.end()) continue;
    Json edge = versioned("PoseGraphEdge");
    edge["source_node_id"] = source->second;
    edge["target_node_id"] = target->second;
    edge["uncertain"] = false;
    edge["confidence"] = 1.0;
    edge["transformation"] = columns(link.target_from_source.matrix());
    edge["information"] = columns(rotation_first(link.information));
    edges.push_back(std::move(edge));
  }
  Json graph = versioned("PoseGraph");
  graph["nodes"] = std::move(nodes);
  graph["edges"] = std::move(edges);
  return graph.dump(1) + '\n';
}

/// 3DTK's frame: centimetres, left-handed, x to the right, y up, z ahead, of a scan with x ahead, y to the left, z up.
Eigen::Matrix4d in_3dtk(const Transform& pose) {
  constexpr double kCentimetresPerMetre = 100;
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, 1, 1, 0, 0;
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = axes * pose.linear() * axes.transpose();
  m.topRightCorner<3, 1>() = kCentimetresPerMetre * (axes * pose.translation());
  return m;
}

/// The angles of R = Rx Ry Rz, as 3DTK composes it; where y is a right angle, z is zero.
Eigen::Vector3d angles_of_3dtk(const Eigen::Matrix4d& m) {
  constexpr double kRightAngle = 1 - 1e-12;
  const double y = std::asin(std::clamp(m(0, 2), -1.0, 1.0));
  if (std::abs(m(0, 2)) > kRightAngle) return {std::atan2(m(2, 1), m(1, 1)), y, 0};
  return {std::atan2(-m(1, 2), m(2, 2)), y, std::atan2(-m(0, 1), m(0, 0))};
}

std::vector<PoseFile> dtk(const std::vector<FinishedScan>& scans) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  constexpr int kMovedByIcp = 1;  // the colour in which 3DTK shows a frame
  std::vector<PoseFile> files;
  CsvTable names;
  names.add("scan").add("name").end_row();
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const Eigen::Matrix4d m = in_3dtk(scans[k].component_from_scan);
    const Eigen::Vector3d angles = kDegPerRad * angles_of_3dtk(m);
    std::string frame, position, turn;
    for (int j = 0; j < 3; ++j) append(position, m(j, 3)), append(turn, angles[j]);
    for (int j = 0; j < 16; ++j) append(frame, m(j % 4, j / 4));
    const std::string stem = fmt::format("scan{:03}", k);
    files.push_back({stem + ".pose", position.substr(1) + '\n' + turn.substr(1) + '\n'});
    files.push_back({stem + ".frames", fmt::format("{} {}\n", frame.substr(1), kMovedByIcp)});
    names.add(stem).add(scans[k].name).end_row();
  }
  files.push_back({"names.csv", names.text()});
  return files;
}

/// "street/a.ply" -> "street/a", "site.e57#2" -> "site#2"
std::string without_extension(const std::string& name) {
  const std::size_t slash = name.rfind('/'), part = name.rfind('#');
  const std::size_t end =
      part == std::string::npos || (slash != std::string::npos && part < slash) ? name.size() : part;
  const std::size_t dot = name.rfind('.', end - 1);
  const bool has_dot = dot != std::string::npos && (slash == std::string::npos || dot > slash + 1) && dot > 0;
  return has_dot ? name.substr(0, dot) + name.substr(end) : name;
}

std::vector<PoseFile> riscan(const std::vector<FinishedScan>& scans) {
  std::vector<PoseFile> files;
  for (const FinishedScan& scan : scans) {
    const Eigen::Matrix4d m = scan.component_from_scan.matrix();
    std::string text;
    for (int row = 0; row < 4; ++row) {
      std::string line;
      for (int column = 0; column < 4; ++column) append(line, m(row, column));
      text += line.substr(1) + '\n';
    }
    files.push_back({without_extension(scan.name) + ".DAT", text});
  }
  return files;
}

}  // namespace

std::optional<PoseFormat> pose_format(std::string_view name) {
  for (const auto& [known, format] : kNames) {
    if (known == name) return format;
  }
  return std::nullopt;
}

std::string export_poses(const FinishedSurvey& survey, int component, PoseFormat format) {
  const std::vector<FinishedScan> scans = scans_of(survey, component);
  switch (format) {
    case PoseFormat::open3d:
      return open3d(survey, scans);
    case PoseFormat::tum:
      return tum(scans);
    case PoseFormat::kitti:
      return kitti(scans);
    case PoseFormat::csv:
      return csv(scans);
    case PoseFormat::dtk:
    case PoseFormat::riscan:
      break;
  }
  return {};
}

bool has_file_per_scan(PoseFormat format) { return format == PoseFormat::dtk || format == PoseFormat::riscan; }

std::vector<PoseFile> export_pose_files(const FinishedSurvey& survey, int component, PoseFormat format) {
  const std::vector<FinishedScan> scans = scans_of(survey, component);
  switch (format) {
    case PoseFormat::dtk:
      return dtk(scans);
    case PoseFormat::riscan:
      return riscan(scans);
    case PoseFormat::open3d:
    case PoseFormat::tum:
    case PoseFormat::kitti:
    case PoseFormat::csv:
      break;
  }
  return {};
}

}  // namespace isthmus::report
