// Exports of a survey that was finished by hand.
#include <gtest/gtest.h>

#include "base/run_program.h"
#include "base/temporary_folder.h"
#include "io/e57/e57_writer.h"
#include "io/las/laz.h"
#include "io/scan_writer.h"

#include <algorithm>
#include <sstream>

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
    std::ofstream(out_ / "resolved.yaml") << "input: \"../scans\"\noutput: \".\"\n";
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

TEST_F(ExportCommand, FormatsWithAFileForEachScanWantAFolder) {
  const testing::Said nowhere = run({"--poses", "3dtk"});
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_NE(nowhere.err.find("-o FOLDER"), std::string::npos) << nowhere.err;
  EXPECT_EQ(run({"--poses", "riscan", "-o", (folder_ / "sop").string()}).exit_code, 0);
  EXPECT_EQ(testing::text_of_file(folder_ / "sop/many#2.DAT"), "0 -1 0 5\n1 0 0 6\n0 0 1 7\n0 0 0 1\n");
  EXPECT_TRUE(fs::exists(folder_ / "sop/sub/a%20b.DAT"));
  EXPECT_EQ(run({"--poses", "3dtk", "-o", (folder_ / "dtk").string()}).exit_code, 0);
  EXPECT_EQ(testing::text_of_file(folder_ / "dtk/names.csv"),
            "scan,name\nscan000,many.e57#0\nscan001,many.e57#2\nscan002,sub/a%20b.ply\n");
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

TEST_F(ExportCommand, PtxHoldsTheScansInTheirOwnFramesAndThePoses) {
  const fs::path file = folder_ / "all.ptx";
  const testing::Said said = run({"--ptx", file.string()});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const auto scans = io::scans_of_file(file);
  ASSERT_TRUE(scans);
  ASSERT_EQ(scans->size(), 3U);
  EXPECT_EQ(points_in(file, 1), points_of(12.0F).points);
  EXPECT_LT((pose_in(file, 1) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(5, 7, 7)).norm(), 1e-9);
  // A second reader, from the format's description.
  std::istringstream in(testing::text_of_file(file));
  for (const float x : {10.0F, 12.0F, 1.0F}) {
    std::size_t columns = 0, rows = 0;
    ASSERT_TRUE(in >> columns >> rows);
    EXPECT_EQ(columns * rows, 100U);
    double skipped = 0;
    for (int k = 0; k < 12; ++k) in >> skipped;
    Eigen::Matrix4d m;
    for (int k = 0; k < 16; ++k) in >> m(k / 4, k % 4);
    EXPECT_EQ(Eigen::Vector4d(m.col(3)), Eigen::Vector4d(0, 0, 0, 1)) << "vectors are rows: the translation lies below";
    for (int i = 0; i < 100; ++i) {
      Eigen::Vector3d p;
      double intensity = -1;
      ASSERT_TRUE(in >> p.x() >> p.y() >> p.z() >> intensity);
      EXPECT_EQ(p, Eigen::Vector3d(static_cast<double>(x), i, 0));
      EXPECT_EQ(intensity, i);
      if (x == 12.0F) {
        EXPECT_LT(((p.homogeneous().transpose() * m).head<3>() - Eigen::RowVector3d(5 - i, 6 + 12, 7)).norm(), 1e-9);
      }
    }
  }
}

TEST_F(ExportCommand, AMergedCloudHasEveryPointWhereItBelongsAndItsSource) {
  std::vector<std::string> names = {"all.ply", "all.pcd", "all.las"};
  if (io::has_laz()) names.emplace_back("all.laz");
  for (const std::string& name : names) {
    const fs::path file = folder_ / name;
    const testing::Said said = run({"--merged", file.string()});
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_NE(said.err.find("300 points of 3 scans"), std::string::npos) << said.err;
    auto reader = io::open_scan({file, 0, {}});
    ASSERT_TRUE(reader) << reader.error().text();
    PointChunk chunk;
    ASSERT_TRUE((*reader)->read(chunk, 1000));
    ASSERT_EQ(chunk.points.size(), 300U) << name;
    ASSERT_EQ(chunk.intensity.size(), 300U) << name;
    const Eigen::Vector3d origin = (*reader)->header().local_origin_in_scan;
    const auto at = [&](std::size_t i) { return Eigen::Vector3d(chunk.points[i].cast<double>() + origin); };
    EXPECT_LT((at(3) - Eigen::Vector3d(10, 3, 0)).norm(), 1e-4) << name;
    EXPECT_LT((at(103) - Eigen::Vector3d(5 - 3, 6 + 12, 7)).norm(), 1e-4) << name;
    EXPECT_LT((at(203) - Eigen::Vector3d(2, 5, 3)).norm(), 1e-4) << name;
    EXPECT_EQ(chunk.intensity[103], 3) << name;
  }
  // Sources are the ids and one; they end each record of the PLY.
  const std::string ply = testing::text_of_file(folder_ / "all.ply");
  constexpr std::size_t kRecord = 24 + 4 + 2;
  const std::size_t first = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), first + 300 * kRecord);
  for (const auto& [point, source] : {std::pair(0U, 1), std::pair(150U, 3), std::pair(299U, 4)})
    EXPECT_EQ(ply[first + point * kRecord + 28], source);
  const std::string las = testing::text_of_file(folder_ / "all.las");
  EXPECT_EQ(las[375 + 150 * 30 + 20], 3) << "the point source id";
}

TEST_F(ExportCommand, AMergedE57HasTheStationsWithTheirPoses) {
  const fs::path file = folder_ / "all.e57";
  const testing::Said said = run({"--merged", file.string()});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("300 points of 3 scans"), std::string::npos) << said.err;
  const auto scans = io::scans_of_file(file);
  ASSERT_TRUE(scans);
  ASSERT_EQ(scans->size(), 3U);
  EXPECT_EQ(points_in(file, 1), points_of(12.0F).points);
  EXPECT_LT((pose_in(file, 1) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(5, 7, 7)).norm(), 1e-12);
  auto reader = io::open_scan({file, 2, {}});
  EXPECT_TRUE(reader && (*reader)->header().has_intensity);

  // The last scan has its first point where the first scan has one at a voxel of 100 m.
  ASSERT_EQ(run({"--merged", file.string(), "--voxel", "100"}).exit_code, 0);
  EXPECT_EQ(points_in(file, 0).size(), 1U);
  EXPECT_EQ(points_in(file, 0)[0], points_of(10.0F).points[0]);
}

TEST_F(ExportCommand, TheReferenceSystemIsStatedWhereTheFormatHasAPlaceForIt) {
  const std::string wkt = "LOCAL_CS[\"site grid\",UNIT[\"metre\",1]]";
  const auto record_id = [](const std::string& las) {
    std::uint16_t id = 0;
    std::memcpy(&id, las.data() + 375 + 18, sizeof id);
    return id;
  };
  const fs::path las = folder_ / "a.las", e57 = folder_ / "a.e57";
  const auto say_frame = [&](const std::string& component) {
    std::ofstream(out_ / "run.json") << R"({"components": [)" << component << "]}";
  };
  say_frame("{}");
  testing::Said said = run({"--merged", las.string(), "--crs", wkt});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("not of a map"), std::string::npos) << said.err;
  std::string bytes = testing::text_of_file(las);
  EXPECT_EQ(bytes[104], 6);
  EXPECT_EQ(bytes[6] & 16, 16) << "the system is WKT";
  EXPECT_EQ(bytes[100], 1);
  EXPECT_EQ(bytes.substr(375 + 2, 16), std::string("LASF_Projection") + '\0');
  EXPECT_EQ(record_id(bytes), 2112);
  EXPECT_EQ(bytes.substr(375 + 54, wkt.size() + 1), wkt + '\0');
  EXPECT_EQ(points_in(las, 0).size(), 300U);

  // Codes go with old point formats: those from 6 on want WKT.
  say_frame(R"({"frame": "world"})");
  said = run({"--merged", las.string(), "--crs", "EPSG:25832+7837"});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_EQ(said.err.find("not of a map"), std::string::npos) << said.err;
  bytes = testing::text_of_file(las);
  EXPECT_EQ(bytes[104], 0);
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(record_id(bytes), 34735);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 107, sizeof count);
  EXPECT_EQ(count, 300U) << "old formats have a count for old programs";
  EXPECT_EQ(points_in(las, 0).size(), 300U);
  EXPECT_EQ(bytes[bytes.size() - 20 + 18], 4) << "the point source id of the last point";

  // E57: whether the scans are written or, all of one E57 file, copied.
  std::ofstream(folder_ / "grid.prj") << wkt << "\n";
  fs::remove(folder_ / "a.las");
  for (const char* option : {"--merged", "--e57"}) {
    ASSERT_EQ(run({option, e57.string(), "--crs", (folder_ / "grid.prj").string()}).exit_code, 0);
    EXPECT_NE(testing::text_of_file(e57).find("<![CDATA[" + wkt + "]]></coordinateMetadata>"), std::string::npos);
  }
  ASSERT_EQ(run({"--e57", (folder_ / "each").string(), "--crs", "EPSG:25832"}).exit_code, 0);
  EXPECT_NE(testing::text_of_file(folder_ / "each/many.e57").find("EPSG:25832"), std::string::npos);
  EXPECT_EQ(points_in(folder_ / "each/many.e57", 1), points_of(12.0F).points);

  EXPECT_EQ(run({"--merged", (folder_ / "a.ply").string(), "--crs", wkt}).exit_code, 1);
  EXPECT_EQ(run({"--poses", "csv", "--crs", wkt}).exit_code, 2);
  said = run({"--merged", las.string(), "--crs", "25832"});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find("--crs: '25832' names no coordinate reference system"), std::string::npos) << said.err;
  EXPECT_FALSE(fs::exists(las));
}

TEST_F(ExportCommand, AVoxelKeepsItsFirstPoint) {
  const fs::path file = folder_ / "thin.ply";
  const testing::Said said = run({"--merged", file.string(), "--voxel", "10"});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find(" points of 3 scans"), std::string::npos) << said.err;
  const std::vector<Eigen::Vector3f> points = points_in(file, 0);
  EXPECT_GT(points.size(), 20U);
  EXPECT_LT(points.size(), 45U);
  EXPECT_EQ(points[0], Eigen::Vector3f(10, 0, 0));
  EXPECT_EQ(points[1], Eigen::Vector3f(10, 10, 0));
  EXPECT_EQ(run({"--merged", (folder_ / "x.obj").string()}).exit_code, 2);
  EXPECT_EQ(run({"--voxel", "1"}).exit_code, 2);
  EXPECT_EQ(run({"--merged", (scans_ / "y.ply").string(), "--component", "1"}).exit_code, 1) << "a scan of the survey";
}

TEST_F(ExportCommand, WhatIsMissingIsNamed) {
  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--poses", "las"}).exit_code, 2);
  EXPECT_EQ(run({"-o", "x"}).exit_code, 2);
  const testing::Said component = run({"--poses", "csv", "--component", "2"});
  EXPECT_EQ(component.exit_code, 1);
  EXPECT_NE(component.err.find("the survey has 2 components, there is no 2"), std::string::npos) << component.err;
  for (const char* text : {"input: \"../gone\"\noutput: \".\"\n", "{}"}) {
    std::ofstream(out_ / "resolved.yaml") << text;
    const testing::Said input = run({"--e57", (folder_ / "x.e57").string()});
    EXPECT_EQ(input.exit_code, 1);
    EXPECT_NE(input.err.find("--scans DIR"), std::string::npos) << input.err;
  }
  EXPECT_EQ(run({"--e57", (folder_ / "x.e57").string(), "--scans", scans_.string()}).exit_code, 0);
  fs::remove(scans_ / "sub/a b.ply");
  const testing::Said scan = run({"--e57", (folder_ / "y.e57").string(), "--scans", scans_.string()});
  EXPECT_EQ(scan.exit_code, 1);
  EXPECT_NE(scan.err.find("a%20b.ply"), std::string::npos) << scan.err;
  EXPECT_FALSE(fs::exists(folder_ / "y.e57"));
}

TEST_F(ExportCommand, NamesThatSayAnotherFormatAreRefused) {
  for (const auto& [option, name] :
       {std::pair("--ptx", "x.las"), std::pair("--e57", "x.las"), std::pair("--merged", "x.txt")}) {
    const testing::Said said = run({option, (folder_ / name).string()});
    EXPECT_EQ(said.exit_code, 2) << said.err;
    EXPECT_NE(said.err.find(name), std::string::npos) << said.err;
    EXPECT_FALSE(fs::exists(folder_ / name));
  }
  const testing::Said voxel = run({"--merged", (folder_ / "x.ply").string(), "--voxel", "-1"});
  EXPECT_EQ(voxel.exit_code, 2);
  EXPECT_NE(voxel.err.find("--voxel: -1 is not above 0\n"), std::string::npos) << voxel.err;
}

TEST_F(ExportCommand, AFolderWithoutASurveyIsSaidToBeOne) {
  out_ = folder_ / "nowhere";
  testing::Said said = run({"--poses", "csv"});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find("nowhere: no such folder"), std::string::npos) << said.err;
  out_ = scans_;
  said = run({"--poses", "csv"});
  EXPECT_NE(said.err.find("no survey was finished in this folder"), std::string::npos) << said.err;
}

TEST_F(ExportCommand, ScansThatWereNamedAsFilesAreFoundAgain) {
  std::ofstream(out_ / "resolved.yaml") << "input:\n  - \"../scans/many.e57\"\n  - \"../scans/sub/a b.ply\"\n"
                                        << "  - \"../scans/y.ply\"\n  - \"../scans/z.ply\"\noutput: \".\"\n";
  const testing::Said said = run({"--merged", (folder_ / "all.ply").string()});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("300 points of 3 scans"), std::string::npos) << said.err;
}

/// The clouds that CloudCompare finds in a file: its reader shares nothing with ours.
class SeenByCloudCompare : public ExportCommand {
 protected:
  std::vector<std::vector<Eigen::Vector3d>> clouds_in(const fs::path& file) {
    const std::string home = "HOME=" + folder_.path().string();  // it keeps settings there
    const testing::Said said = testing::run_program(
        "/usr/bin/env",
        {home, "QT_QPA_PLATFORM=offscreen", "timeout", "120", "CloudCompare", "-SILENT", "-C_EXPORT_FMT", "ASC",
         "-PREC", "9", "-NO_TIMESTAMP", "-O", file.string(), "-SAVE_CLOUDS"},
        folder_.path());
    EXPECT_EQ(said.exit_code, 0) << said.out << said.err;
    std::vector<fs::path> tables;
    for (const auto& entry : fs::directory_iterator(file.parent_path()))
      if (entry.path().extension() == ".asc") tables.push_back(entry.path());
    std::sort(tables.begin(), tables.end());
    std::vector<std::vector<Eigen::Vector3d>> clouds;
    for (const fs::path& table : tables) {
      std::istringstream lines(testing::text_of_file(table));
      clouds.emplace_back();
      for (std::string line; std::getline(lines, line);) {
        Eigen::Vector3d p;
        std::istringstream(line) >> p.x() >> p.y() >> p.z();
        clouds.back().push_back(p);
      }
      fs::remove(table);
    }
    return clouds;
  }
};

TEST_F(SeenByCloudCompare, ScansOfPtxAndPointsOfPlyStandWhereTheirPosesSay) {
  if (!fs::exists("/usr/bin/CloudCompare")) GTEST_SKIP() << "no CloudCompare: apt-get install cloudcompare";
  const auto expected = [](std::size_t scan, std::size_t i) {
    const auto y = static_cast<double>(i);
    return scan == 0   ? Eigen::Vector3d(10, y, 0)
           : scan == 1 ? Eigen::Vector3d(5 - y, 6 + 12, 7)
                       : Eigen::Vector3d(1 + 1, y + 2, 3);
  };
  constexpr double kFloat = 1e-5;  // it computes in floats
  const fs::path folder = folder_ / "seen";
  fs::create_directories(folder);
  ASSERT_EQ(run({"--ptx", (folder / "all.ptx").string()}).exit_code, 0);
  auto clouds = clouds_in(folder / "all.ptx");
  ASSERT_EQ(clouds.size(), 3U);
  for (std::size_t scan = 0; scan < 3; ++scan) {
    ASSERT_EQ(clouds[scan].size(), 100U);
    for (std::size_t i = 0; i < 100; ++i) EXPECT_LT((clouds[scan][i] - expected(scan, i)).norm(), kFloat);
  }
  ASSERT_EQ(run({"--merged", (folder / "all.ply").string()}).exit_code, 0);
  clouds = clouds_in(folder / "all.ply");
  ASSERT_EQ(clouds.size(), 1U);
  ASSERT_EQ(clouds[0].size(), 300U);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_LT((clouds[0][i] - expected(i / 100, i % 100)).norm(), kFloat);
}

}  // namespace
}  // namespace isthmus
