// One simulated pair through the program: JSON, matrix file, exit codes, map coordinates.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/run_program.h"
#include "base/temporary_folder.h"
#include "geometry/transform.h"
#include "io/scan_reader.h"
#include "io/scan_writer.h"
#include "simulate/simulate.h"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Transform transform_of(std::istream& in, int num_values) {
  Transform t = Transform::Identity();
  for (int k = 0; k < num_values; ++k) in >> t.matrix()(k / 4, k % 4);
  return t;
}

/// Two stations of an office, made anew in the test's folder.
class PairCommand : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  fs::path scans_ = folder_ / "scans";
  Transform target_from_source_ = Transform::Identity();  ///< truth for scan_001 -> scan_000

  void SetUp() override {
    SimulateOptions options;
    options.scene = "office";
    options.output = scans_.string();
    options.stations = 2;
    options.resolution_deg = 0.5;
    ASSERT_TRUE(simulate(options));
    std::ifstream truth(scans_ / "poses.gt.txt");
    std::vector<Transform> poses;
    for (std::string line; std::getline(truth, line);) {
      std::istringstream words(line);
      std::string name;
      words >> name;
      if (!name.starts_with('#')) poses.push_back(transform_of(words, 12));
    }
    ASSERT_EQ(poses.size(), 2U);
    target_from_source_ = poses[0].inverse() * poses[1];
  }

  testing::Said pair(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "pair");
    return testing::run_program(ISTHMUS_PROGRAM, arguments, folder_.path());
  }
  std::string scan(const std::string& name) const { return (scans_ / name).string(); }

  /// Whatever became of the pair.
  static void expect_every_key(const Json& json) {
    for (const char* key :
         {"verdict", "reason", "probability", "overlap", "overlap_of_source", "overlap_of_target", "rms_m", "voxel_m",
          "transform", "information", "evidence", "counts", "from_store", "seconds"}) {
      EXPECT_TRUE(json.contains(key)) << key;
    }
    EXPECT_EQ(json.size(), 14U) << json;
    EXPECT_TRUE(json["evidence"].contains("score")) << json["evidence"];
    EXPECT_TRUE(json["seconds"].is_object());
    EXPECT_EQ(json["transform"].is_null(), json["information"].is_null());
    EXPECT_EQ(json["transform"].is_null(), json["overlap"].is_null());
    EXPECT_EQ(json["transform"].is_null(), json["evidence"]["score"].is_null());
  }

  static void expect_near(const Transform& a, const Transform& b, double metres) {
    EXPECT_LT(rotation_angle_rad(a.linear().transpose() * b.linear()), 0.005);
    EXPECT_LT((a.translation() - b.translation()).norm(), metres);
  }
};

TEST_F(PairCommand, finds_the_pose_and_prints_one_json_object) {
  const std::string file = (folder_ / "T.txt").string();
  const testing::Said said = pair({scan("scan_001.ply"), scan("scan_000.ply"), "-o", file});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const Json json = Json::parse(said.out);
  EXPECT_EQ(json["verdict"], "accepted");
  expect_every_key(json);
  std::ifstream in(file);
  const Transform found = transform_of(in, 16);
  expect_near(found, target_from_source_, 0.05);
  for (int k = 0; k < 16; ++k) EXPECT_EQ(json["transform"][k / 4][k % 4].get<double>(), found.matrix()(k / 4, k % 4));
  EXPECT_EQ(json["information"].size(), 6U);
}

TEST_F(PairCommand, takes_everything_from_a_store_the_second_time) {
  const std::vector<std::string> arguments = {scan("scan_001.ply"), scan("scan_000.ply"), "--store",
                                              (folder_ / "kept").string()};
  const Json first = Json::parse(pair(arguments).out);
  const Json second = Json::parse(pair(arguments).out);
  EXPECT_EQ(first["from_store"], false);
  EXPECT_EQ(second["from_store"], true);
  EXPECT_EQ(first["transform"], second["transform"]);
}

TEST_F(PairCommand, gives_the_transform_between_map_coordinates) {
  // The same scans, shifted to where a national grid would put them: float64 coordinates in the files.
  const Eigen::Vector3d source_shift(500000, 5240000, 300), target_shift(500020, 5240010, 310);
  const auto shifted = [&](const std::string& name, const Eigen::Vector3d& shift) {
    const fs::path path = folder_ / ("map_" + name);
    const auto reader = io::open_scan({scans_ / name, 0, name}).value();
    PointChunk all, chunk;
    while (reader->read(chunk, 100000) && !chunk.points.empty()) {
      all.points.insert(all.points.end(), chunk.points.begin(), chunk.points.end());
    }
    EXPECT_TRUE(io::write_scan(
        path, all, {.local_origin_in_scan = shift, .double_coordinates = {}, .station_in_scan = {}, .comments = {}}));
    return path.string();
  };
  const std::string source = shifted("scan_001.ply", source_shift), target = shifted("scan_000.ply", target_shift);
  const std::string file = (folder_ / "T.txt").string();
  const testing::Said said = pair({source, target, "-o", file});
  EXPECT_NE(said.exit_code, 1) << said.err << said.out;  // without a known station the verdict may be ambiguous
  std::ifstream in(file);
  const Transform found = transform_of(in, 16);
  EXPECT_LT((found.linear().transpose() * found.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  const Eigen::Vector3d p_in_source(3, 2, 1);
  const Eigen::Vector3d expected = target_from_source_ * p_in_source + target_shift;
  EXPECT_LT((found * (p_in_source + source_shift) - expected).norm(), 0.05);
}

TEST_F(PairCommand, is_1_for_an_unreadable_scan_and_still_prints_one_object) {
  std::ofstream(folder_ / "bad.ply") << "ply\nformat nonsense 1.0\n";
  const std::string file = (folder_ / "T.txt").string();
  for (const std::string& bad : {(folder_ / "bad.ply").string(), (folder_ / "missing.ply").string()}) {
    std::ofstream(file) << "of an earlier run\n";
    const testing::Said said = pair({bad, scan("scan_000.ply"), "-o", file});
    EXPECT_EQ(said.exit_code, 1);
    const Json json = Json::parse(said.out);
    expect_every_key(json);
    EXPECT_EQ(json["verdict"], "failed");
    EXPECT_EQ(json["probability"], 0);
    EXPECT_TRUE(json["transform"].is_null());
    EXPECT_NE(said.err.find(fs::path(bad).filename().string()), std::string::npos) << said.err;
    EXPECT_FALSE(fs::exists(file)) << "a matrix of an earlier run passes for this one's";
  }
}

TEST_F(PairCommand, refuses_to_write_over_a_scan_or_into_nowhere) {
  const std::string source = scan("scan_001.ply"), target = scan("scan_000.ply");
  EXPECT_EQ(pair({source, target, "-o", source}).exit_code, 2);
  EXPECT_EQ(pair({source, target, "-o", target}).exit_code, 2);
  EXPECT_TRUE(fs::exists(source) && fs::exists(target));
  for (const std::string& file : {(folder_ / "no" / "folder.txt").string(), scans_.string()}) {
    const testing::Said said = pair({source, target, "-o", file});
    EXPECT_EQ(said.exit_code, 1);
    expect_every_key(Json::parse(said.out));
    EXPECT_NE(said.err.find(file), std::string::npos) << said.err;
  }
}

TEST_F(PairCommand, needs_no_folder_for_what_it_computes_in_between) {
  std::ofstream(folder_ / "file") << "no folder";
  const std::string file = (folder_ / "file").string();
  ASSERT_EQ(::setenv("TMPDIR", file.c_str(), 1), 0);
  const testing::Said said = pair({scan("scan_001.ply"), scan("scan_000.ply")});
  ::unsetenv("TMPDIR");
  EXPECT_EQ(said.exit_code, 0) << said.err;
}

TEST_F(PairCommand, scans_in_different_units_are_a_failed_pair_that_says_why) {
  const auto reader = io::open_scan({scans_ / "scan_001.ply", 0, "scan_001.ply"}).value();
  PointChunk all;
  ASSERT_TRUE(reader->read(all, 10'000'000));
  for (Eigen::Vector3f& p : all.points) p *= 1000;
  ASSERT_TRUE(io::write_scan(folder_ / "millimetres.ply", all));
  const std::string file = (folder_ / "T.txt").string();
  std::ofstream(file) << "of an earlier run\n";
  const testing::Said said = pair({(folder_ / "millimetres.ply").string(), scan("scan_000.ply"), "-o", file});
  EXPECT_EQ(said.exit_code, 3) << said.err;
  const Json json = Json::parse(said.out);
  expect_every_key(json);
  EXPECT_EQ(json["verdict"], "failed");
  const std::string reason = json["reason"];
  EXPECT_NE(reason.find("millimetres.ply: its extent is "), std::string::npos) << reason;
  EXPECT_NE(reason.find("looks like millimetres among metres"), std::string::npos) << reason;
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(PairCommand, is_3_when_nothing_is_to_be_found) {
  // A plane and a sphere of the office's size: no pose of one on the other means anything.
  std::ofstream plane(folder_ / "plane.xyz"), sphere(folder_ / "sphere.xyz");
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 200; ++j) {
      plane << i * 0.03 << ' ' << j * 0.03 << " -1.5\n";
      const double a = i * 0.0314, b = (j + 0.5) * 0.0157;
      sphere << 3 + 2 * std::cos(a) * std::sin(b) << ' ' << 2 * std::sin(a) * std::sin(b) << ' ' << 2 * std::cos(b)
             << '\n';
    }
  }
  plane.close();
  sphere.close();
  const testing::Said said = pair({(folder_ / "plane.xyz").string(), (folder_ / "sphere.xyz").string()});
  EXPECT_EQ(said.exit_code, 3) << said.out << said.err;
  expect_every_key(Json::parse(said.out));
  EXPECT_NE(Json::parse(said.out)["verdict"], "accepted");
}

}  // namespace
}  // namespace isthmus
