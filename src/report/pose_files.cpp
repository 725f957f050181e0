#include "report/pose_files.h"

#include <iterator>

#include <fmt/format.h>

namespace isthmus::report {
namespace {

// The shortest text that reads back as the same double; adding zero turns -0 into 0.
void append(std::string& out, double value) { fmt::format_to(std::back_inserter(out), " {}", value + 0.0); }

void append_pose(std::string& out, const Transform& t) {
  Eigen::Quaterniond q = Eigen::Quaterniond(t.linear()).normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  for (int k = 0; k < 3; ++k) append(out, t.translation()[k]);
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) append(out, value);
}

}  // namespace

Matrix6d g2o_information(const Matrix6d& information) {
  Matrix6d out = information;
  out.topRightCorner<3, 3>() *= 2.0;
  out.bottomLeftCorner<3, 3>() *= 2.0;
  out.bottomRightCorner<3, 3>() *= 4.0;
  return out;
}

std::string poses_text(const SurveyRecord& record) {
  std::string out;
  for (const ScanRecord& scan : record.scans) {
    if (scan.status != ScanStatus::placed) continue;
    const Transform pose = component_from_scan(record, scan.id);
    out += scan.name;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) append(out, pose(row, column));
    out += '\n';
  }
  return out;
}

std::string pose_graph_g2o(const SurveyRecord& record) {
  std::string out;
  for (const ScanRecord& scan : record.scans) {
    if (scan.status != ScanStatus::placed) continue;
    out += fmt::format("VERTEX_SE3:QUAT {}", scan.id);
    append_pose(out, component_from_scan(record, scan.id));
    out += '\n';
  }
  for (const SolvedLink& l : record.solution.links) {
    if (l.link.result.verdict != Verdict::accepted) continue;
    out += fmt::format("EDGE_SE3:QUAT {} {}", l.link.target, l.link.source);
    append_pose(out, target_from_source_in_scans(record, l.link));
    const Eigen::Vector3d& origin = find_scan(record, l.link.source)->local_origin_in_scan;
    const Matrix6d information = g2o_information(information_in_scan(l.information_used, origin));
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) append(out, information(row, column));
    out += '\n';
  }
  return out;
}

}  // namespace isthmus::report
