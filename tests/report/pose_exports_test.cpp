#include "report/pose_exports.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/temporary_folder.h"
#include "report/sample_record.h"
#include "report/write_outputs.h"

namespace isthmus::report {
namespace {

using isthmus::testing::sample_record;

/// A survey written as 'register' does and read back.
class PoseExports : public ::testing::Test {
 protected:
  void SetUp() override {
    record = sample_record(30);
    const auto written = write_outputs(record, folder.path());
    ASSERT_TRUE(written) << written.error().text();
    auto read = read_finished_survey(folder.path());
    ASSERT_TRUE(read) << read.error().text();
    survey = std::move(*read);
  }
  /// The scans of the largest component, by the record.
  std::vector<int> ids_of_largest() const {
    std::vector<int> ids = record.solution.components[0].scans;
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  testing::TemporaryFolder folder;
  SurveyRecord record;
  FinishedSurvey survey;
};

TEST_F(PoseExports, TheSurveyReadBackIsTheOneWritten) {
  std::size_t placed = 0;
  for (const ScanRecord& scan : record.scans) {
    if (scan.status != ScanStatus::placed) continue;
    ASSERT_LT(placed, survey.scans.size());
    const FinishedScan& read = survey.scans[placed++];
    EXPECT_EQ(read.id, scan.id);
    EXPECT_EQ(read.name, scan.name);
    EXPECT_EQ(read.component, component_of(record, scan.id));
    EXPECT_TRUE(read.component_from_scan.isApprox(component_from_scan(record, scan.id), 1e-12));
  }
  EXPECT_EQ(placed, survey.scans.size());
  std::size_t accepted = 0;
  for (const SolvedLink& l : record.solution.links) {
    if (l.link.result.verdict != Verdict::accepted) continue;
    const FinishedLink& read = survey.links.at(accepted++);
    EXPECT_EQ(read.source, l.link.source);
    EXPECT_EQ(read.target, l.link.target);
    EXPECT_TRUE(read.target_from_source.isApprox(target_from_source_in_scans(record, l.link), 1e-12));
    const Matrix6d expected =
        information_in_scan(l.information_used, find_scan(record, l.link.source)->local_origin_in_scan);
    EXPECT_TRUE(read.information.isApprox(expected, 1e-9));
  }
  EXPECT_EQ(accepted, survey.links.size());
  EXPECT_GT(accepted, 20U);
}

TEST_F(PoseExports, TumAndKittiAndCsvHoldThePosesOfOneComponent) {
  const std::vector<int> ids = ids_of_largest();
  ASSERT_LT(ids.size(), record.scans.size());
  std::istringstream tum(export_poses(survey, 0, PoseFormat::tum));
  std::istringstream kitti(export_poses(survey, 0, PoseFormat::kitti));
  std::istringstream csv(export_poses(survey, 0, PoseFormat::csv));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "name,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33");
  for (const int id : ids) {
    const Eigen::Matrix4d expected = component_from_scan(record, id).matrix();
    double t = -1, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
    ASSERT_TRUE(tum >> t >> x >> y >> z >> qx >> qy >> qz >> qw);
    EXPECT_EQ(t, id);
    EXPECT_LT((Eigen::Vector3d(x, y, z) - expected.topRightCorner<3, 1>()).norm(), 1e-9);
    EXPECT_TRUE(Eigen::Quaterniond(qw, qx, qy, qz).toRotationMatrix().isApprox(expected.topLeftCorner<3, 3>(), 1e-9));
    ASSERT_TRUE(std::getline(csv, line));
    std::istringstream fields(line);
    std::string name;
    std::getline(fields, name, ',');
    EXPECT_EQ(name, find_scan(record, id)->name);
    for (int k = 0; k < 16; ++k) {
      double value = 0;
      std::string field;
      std::getline(fields, field, ',');
      EXPECT_NEAR(std::stod(field), expected(k / 4, k % 4), 1e-12);
      if (k < 12) {
        ASSERT_TRUE(kitti >> value);
        EXPECT_NEAR(value, expected(k / 4, k % 4), 1e-12);
      }
    }
  }
  EXPECT_FALSE(tum >> line);
  EXPECT_FALSE(kitti >> line);
  EXPECT_FALSE(std::getline(csv, line));
  EXPECT_TRUE(export_poses(survey, 99, PoseFormat::tum).empty());
}

// 3DTK's own composition of a .pose (Nuechter's EulerToMatrix4, column by column), as a second reader.
Eigen::Matrix4d read_pose_of_3dtk(const std::string& text) {
  std::istringstream in(text);
  double x = 0, y = 0, z = 0, a = 0, b = 0, c = 0;
  EXPECT_TRUE(in >> x >> y >> z >> a >> b >> c) << text;
  const double rad = std::acos(-1.0) / 180;
  const double sx = std::sin(a * rad), cx = std::cos(a * rad), sy = std::sin(b * rad), cy = std::cos(b * rad),
               sz = std::sin(c * rad), cz = std::cos(c * rad);
  Eigen::Matrix4d m;
  m.transpose() << cy * cz, sx * sy * cz + cx * sz, -cx * sy * cz + sx * sz, 0,  //
      -cy * sz, -sx * sy * sz + cx * cz, cx * sy * sz + sx * cz, 0,              //
      sy, -sx * cy, cx * cy, 0,                                                  //
      x, y, z, 1;
  return m;
}

TEST_F(PoseExports, Files3dtkReadsPutAPointWhereOursDo) {
  const std::vector<int> ids = ids_of_largest();
  std::map<std::string, std::string> files;
  for (const PoseFile& file : export_pose_files(survey, 0, PoseFormat::dtk)) files[file.name] = file.text;
  ASSERT_EQ(files.size(), 2 * ids.size() + 1);
  const Eigen::Vector3d p_in_scan(3, -2, 1);
  // A scan of ours in 3DTK's coordinates: centimetres, x to the right, y up, z ahead.
  const auto to_3dtk = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(-100 * p.y(), 100 * p.z(), 100 * p.x()); };
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const Eigen::Vector3d expected = to_3dtk(component_from_scan(record, ids[k]) * p_in_scan);
    const std::string stem = fmt::format("scan{:03}", k);
    const Eigen::Matrix4d pose = read_pose_of_3dtk(files.at(stem + ".pose"));
    EXPECT_LT(((pose * to_3dtk(p_in_scan).homogeneous()).head<3>() - expected).norm(), 1e-6) << stem;
    std::istringstream in(files.at(stem + ".frames"));
    Eigen::Matrix4d frame;
    for (int j = 0; j < 16; ++j) in >> frame(j % 4, j / 4);
    int type = -1;
    EXPECT_TRUE(in >> type);
    EXPECT_LT(((frame * to_3dtk(p_in_scan).homogeneous()).head<3>() - expected).norm(), 1e-6) << stem;
    EXPECT_NE(files.at("names.csv").find(stem + "," + find_scan(record, ids[k])->name + "\n"), std::string::npos);
  }
}

TEST_F(PoseExports, PosesOf3dtkHoldWhereItsAnglesAreNotUnique) {
  for (const double sign : {-1.0, 1.0}) {
    FinishedSurvey straight;
    FinishedScan scan;
    // In 3DTK's axes a turn by a right angle about y.
    scan.component_from_scan.linear() = (Eigen::AngleAxisd(sign * std::acos(0.0), Eigen::Vector3d::UnitZ()) *
                                         Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))
                                            .toRotationMatrix();
    straight.scans.push_back(scan);
    const Eigen::Matrix4d pose = read_pose_of_3dtk(export_pose_files(straight, 0, PoseFormat::dtk).front().text);
    Eigen::Matrix3d axes;
    axes << 0, -1, 0, 0, 0, 1, 1, 0, 0;
    EXPECT_TRUE(
        (pose.topLeftCorner<3, 3>()).isApprox(axes * scan.component_from_scan.linear() * axes.transpose(), 1e-6));
  }
}

TEST_F(PoseExports, RiscanHasTheMatrixOfEachScanUnderItsName) {
  const std::vector<int> ids = ids_of_largest();
  const std::vector<PoseFile> files = export_pose_files(survey, 0, PoseFormat::riscan);
  ASSERT_EQ(files.size(), ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k) {
    EXPECT_EQ(files[k].name, fmt::format("street/station_{:03}.DAT", ids[k]));
    std::istringstream in(files[k].text);
    Eigen::Matrix4d m;
    for (int j = 0; j < 16; ++j) EXPECT_TRUE(in >> m(j / 4, j % 4));
    EXPECT_TRUE(m.isApprox(component_from_scan(record, ids[k]).matrix(), 1e-12));
  }
  survey.scans[0].name = "site.v2/many.e57#3";
  EXPECT_EQ(export_pose_files(survey, survey.scans[0].component, PoseFormat::riscan)[0].name, "site.v2/many#3.DAT");
  survey.scans[0].name = "site.v2/plain";
  EXPECT_EQ(export_pose_files(survey, survey.scans[0].component, PoseFormat::riscan)[0].name, "site.v2/plain.DAT");
}

// The error that Open3D minimises, differentiated: the same cost as the solver's information gives.
TEST_F(PoseExports, Open3dEdgesFitTheirNodesAndWeighRotationFirst) {
  const auto graph = nlohmann::json::parse(export_poses(survey, 0, PoseFormat::open3d));
  EXPECT_EQ(graph["class_name"], "PoseGraph");
  EXPECT_EQ(graph["version_major"], 1);
  const std::vector<int> ids = ids_of_largest();
  ASSERT_EQ(graph["nodes"].size(), ids.size());
  const auto matrix = [](const nlohmann::json& values) {
    Eigen::MatrixXd m(values.size() == 16 ? 4 : 6, values.size() == 16 ? 4 : 6);
    for (Eigen::Index k = 0; k < m.size(); ++k) m.data()[k] = values[static_cast<std::size_t>(k)];  // by columns
    return m;
  };
  for (std::size_t k = 0; k < ids.size(); ++k) {
    EXPECT_TRUE(matrix(graph["nodes"][k]["pose"]).isApprox(component_from_scan(record, ids[k]).matrix(), 1e-9));
  }
  std::size_t e = 0;
  for (const FinishedLink& link : survey.links) {
    const auto source = std::find(ids.begin(), ids.end(), link.source),
               target = std::find(ids.begin(), ids.end(), link.target);
    if (source == ids.end()) continue;
    const auto& edge = graph["edges"][e++];
    EXPECT_EQ(edge["source_node_id"], source - ids.begin());
    EXPECT_EQ(edge["target_node_id"], target - ids.begin());
    EXPECT_EQ(edge["uncertain"], false);
    EXPECT_TRUE(matrix(edge["transformation"]).isApprox(link.target_from_source.matrix(), 1e-12));
    const Eigen::MatrixXd information = matrix(edge["information"]);
    Vector6d ours, theirs;
    ours << 0.1, -0.2, 0.3, 0.01, 0.02, -0.03;
    theirs << ours.tail<3>(), ours.head<3>();
    EXPECT_NEAR(theirs.dot(information * theirs) / ours.dot(link.information * ours), 1.0, 1e-9);
  }
  EXPECT_EQ(graph["edges"].size(), e);
  EXPECT_GT(e, 20U);
}

TEST_F(PoseExports, BrokenOutputsAreNamed) {
  const auto error = [&] {
    const auto read = read_finished_survey(folder.path());
    return read ? std::string("no error") : read.error().text();
  };
  std::ofstream(folder / "poses.txt", std::ios::app) << "a 1 2 3\n";
  EXPECT_NE(error().find("poses.txt, line " + std::to_string(survey.scans.size() + 1)), std::string::npos) << error();
  std::ofstream(folder / "poses.txt") << "a 1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_NE(error().find("1 poses, but pose_graph.g2o has"), std::string::npos) << error();
  std::ofstream(folder / "pose_graph.g2o") << "VERTEX_SE3:QUAT 3 0 0 0 0 0 0 1\nEDGE_SE3:QUAT 3 x\n";
  EXPECT_NE(error().find("pose_graph.g2o, line 2"), std::string::npos) << error();
  std::filesystem::remove(folder / "poses.txt");
  std::ofstream(folder / "pose_graph.g2o") << "";
  EXPECT_NE(error().find("poses.txt"), std::string::npos) << error();
}

TEST(PoseFormats, HaveNames) {
  EXPECT_EQ(pose_format("kitti"), PoseFormat::kitti);
  EXPECT_FALSE(pose_format("KITTI").has_value());
}

}  // namespace
}  // namespace isthmus::report
