// Exports of a survey that was finished by hand.
#include <gtest/gtest.h>

#include "base/run_program.h"
#include "base/temporary_folder.h"
#include "io/e57/e57_writer.h"
#include "io/scan_writer.h"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

class ExportCommand : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  fs::path scans_ = folder_ / "scans", out_ = folder_ / "out";

  static PointChunk points_of(float x) {
    PointChunk points;
    for (int i = 0; i < 100; ++i) {
      points.points.emplace_back(x, static_cast<float>(i), 0.0F);
      points.intensity.push_back(static_cast<float>(i));
    }
    return points;
  }

  // Three placed scans of two files in component 0, two in component 1.
  void SetUp() override {
    fs::create_directories(scans_ / "sub");
    fs::create_directories(out_);
    for (const char* name : {"sub/a b.ply", "y.ply", "z.ply"}) {
      ASSERT_TRUE(io::write_scan(scans_ / name, points_of(1.0F)));
    }
    auto writer = io::E57Writer::create(scans_ / "many.e57");
    ASSERT_TRUE(writer);
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(writer->begin_scan({"scan " + std::to_string(k), {}, Transform::Identity(), false, true, false}));
      ASSERT_TRUE(writer->add(points_of(static_cast<float>(10 + k))));
    }
    ASSERT_TRUE(writer->publish());
    const std::string rest = " 0 0 0 0 0 0 1";
    std::string information;
    for (int k = 0; k < 21; ++k)
      information += k == 0 || k == 6 || k == 11 || k == 15 || k == 18 || k == 20 ? " 4" : " 0";
    std::ofstream(out_ / "poses.txt") << "many.e57#0 1 0 0 0 0 1 0 0 0 0 1 0\n"
                                         "many.e57#2 0 -1 0 5 1 0 0 6 0 0 1 7\n"
                                         "sub/a%20b.ply 1 0 0 1 0 1 0 2 0 0 1 3\n"
                                         "y.ply 1 0 0 0 0 1 0 0 0 0 1 0\n"
                                         "z.ply 1 0 0 0 0 1 0 9 0 0 1 0\n";
    std::ofstream graph(out_ / "pose_graph.g2o");
    for (const int id : {0, 2, 3, 4, 5}) graph << "VERTEX_SE3:QUAT " << id << rest << "\n";
    for (const char* ids : {"0 2", "0 3", "4 5"}) graph << "EDGE_SE3:QUAT " << ids << rest << information << "\n";
    graph.close();
    std::ofstream(out_ / "run.json") << R"({"run": {"input": ")" << scans_.string() << "\"}}\n";
  }
  testing::Said run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"export", out_.string()});
    return testing::run_program(ISTHMUS_PROGRAM, arguments, folder_.path());
  }
  static std::vector<Eigen::Vector3f> points_in(const fs::path& file, int index) {
    auto reader = io::open_scan({file, index, {}});
    PointChunk chunk;
    EXPECT_TRUE(reader && (*reader)->read(chunk, 1000)) << file;
    return chunk.points;
  }
  static Transform pose_in(const fs::path& file, int index) {
    auto reader = io::open_scan({file, index, {}});
    EXPECT_TRUE(reader && (*reader)->header().file_from_scan) << file;
    return reader && (*reader)->header().file_from_scan ? *(*reader)->header().file_from_scan : Transform::Identity();
  }
};

TEST_F(ExportCommand, PosesGoToStandardOutputOrAFile) {
  const testing::Said tum = run({"--poses", "tum"});
  EXPECT_EQ(tum.exit_code, 0) << tum.err;
  EXPECT_TRUE(tum.out.starts_with("0 0 0 0 0 0 0 1\n2 5 6 7 0 0 0.7071067811865")) << tum.out;
  EXPECT_NE(tum.err.find("2 scans in other components"), std::string::npos) << tum.err;
  const testing::Said kitti = run({"--poses", "kitti", "--component", "1", "-o", (folder_ / "k.txt").string()});
  EXPECT_EQ(kitti.exit_code, 0) << kitti.err;
  EXPECT_EQ(kitti.out, "");
  EXPECT_EQ(testing::text_of_file(folder_ / "k.txt"), "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 9 0 0 1 0\n");
}

TEST_F(ExportCommand, ScansGoIntoOneE57WithTheirPoses) {
  const fs::path file = folder_ / "all.e57";
  const testing::Said said = run({"--e57", file.string()});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  const auto scans = io::scans_of_file(file);
  ASSERT_TRUE(scans);
  ASSERT_EQ(scans->size(), 3U);
  EXPECT_EQ(points_in(file, 1), points_of(12.0F).points);
  EXPECT_EQ(points_in(file, 2), points_of(1.0F).points);
  EXPECT_LT((pose_in(file, 1) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(5, 7, 7)).norm(), 1e-12);
  EXPECT_LT((pose_in(file, 2).translation() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST_F(ExportCommand, ScansGoIntoAFolderFileByFileAndE57IsCopied) {
  const fs::path folder = folder_ / "registered";
  const testing::Said said = run({"--e57", folder.string()});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_EQ(points_in(folder / "sub/a b.e57", 0), points_of(1.0F).points);
  const auto scans = io::scans_of_file(folder / "many.e57");
  ASSERT_TRUE(scans);
  ASSERT_EQ(scans->size(), 2U);  // the scan that was not placed is left out
  EXPECT_EQ(points_in(folder / "many.e57", 1), points_of(12.0F).points);
  EXPECT_LT((pose_in(folder / "many.e57", 1).translation() - Eigen::Vector3d(5, 6, 7)).norm(), 1e-12);
  const std::string before = testing::text_of_file(scans_ / "many.e57");
  const std::string after = testing::text_of_file(folder / "many.e57");
  EXPECT_EQ(before.substr(1024, 2048), after.substr(1024, 2048));  // pages of points
  const testing::Said onto_itself = run({"--e57", scans_.string()});
  EXPECT_EQ(onto_itself.exit_code, 1);
  EXPECT_NE(onto_itself.err.find("would be overwritten"), std::string::npos) << onto_itself.err;
  EXPECT_EQ(testing::text_of_file(scans_ / "many.e57"), before);
}

TEST_F(ExportCommand, WhatIsMissingIsNamed) {
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--poses", "las"}).exit_code, 2);
  EXPECT_EQ(run({"-o", "x"}).exit_code, 2);
  const testing::Said component = run({"--poses", "csv", "--component", "2"});
  EXPECT_EQ(component.exit_code, 1);
  EXPECT_NE(component.err.find("the survey has 2 components, there is no 2"), std::string::npos) << component.err;
  std::ofstream(out_ / "run.json") << "{}";
  const testing::Said input = run({"--e57", (folder_ / "x.e57").string()});
  EXPECT_EQ(input.exit_code, 1);
  EXPECT_NE(input.err.find("--scans DIR"), std::string::npos) << input.err;
  EXPECT_EQ(run({"--e57", (folder_ / "x.e57").string(), "--scans", scans_.string()}).exit_code, 0);
  fs::remove(scans_ / "sub/a b.ply");
  const testing::Said scan = run({"--e57", (folder_ / "y.e57").string(), "--scans", scans_.string()});
  EXPECT_EQ(scan.exit_code, 1);
  EXPECT_NE(scan.err.find("a%20b.ply"), std::string::npos) << scan.err;
  EXPECT_FALSE(fs::exists(folder_ / "y.e57"));
}

}  // namespace
}  // namespace isthmus
