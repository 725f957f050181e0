#include "report/pose_exports.h"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "report/csv.h"

namespace isthmus::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, PoseFormat>, 4> kNames = {{
    {"open3d", PoseFormat::open3d},
    {"tum", PoseFormat::tum},
    {"kitti", PoseFormat::kitti},
    {"csv", PoseFormat::csv},
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
  }
  return {};
}

}  // namespace isthmus::report
