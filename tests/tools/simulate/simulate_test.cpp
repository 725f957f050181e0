// Whole simulated surveys: files, truth, determinism.
#include "simulate/simulate.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "base/atomic_file.h"
#include "io/scan_reader.h"
#include "simulate/scene.h"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

class Simulate : public testing::Test {
 protected:
  fs::path folder_ = fs::temp_directory_path() / ("isthmus_simulate_" + std::to_string(::getpid()));
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] SimulateOptions options(const std::string& scene, int stations, double resolution_deg) const {
    SimulateOptions o;
    o.scene = scene;
    o.stations = stations;
    o.resolution_deg = resolution_deg;
    o.output = (folder_ / scene).string();
    return o;
  }
};

std::map<std::string, Transform> read_poses(const fs::path& path) {
  std::map<std::string, Transform> poses;
  std::istringstream lines(read_file(path).value());
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    Transform pose = Transform::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) words >> pose.matrix()(r, c);
    }
    EXPECT_FALSE(words.fail()) << line;
    poses[name] = pose;
  }
  return poses;
}

io::PointChunk read_points(const fs::path& path) {
  auto reader = io::open_scan({path, 0, path.filename().string()});
  EXPECT_TRUE(reader) << reader.error().text();
  io::PointChunk chunk;
  EXPECT_TRUE((*reader)->read(chunk, 100'000'000));
  return chunk;
}

/// Distance from p to the nearest triangle: brute force over all triangles (Ericson 2005, 5.1.5, by clamping in three
/// steps).
double distance_to(const sim::Mesh& mesh, const sim::Vector3d& p) {
  const auto to_segment = [&](const sim::Vector3d& a, const sim::Vector3d& b) {
    const sim::Vector3d ab = b - a;
    return (a + std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) * ab - p).norm();
  };
  double best = 1e9;
  for (const auto& t : mesh.triangles) {
    const sim::Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                        c = mesh.vertices[t[2]].cast<double>(), n = (b - a).cross(c - a);
    if ((p - a).cwiseAbs().maxCoeff() > 60) continue;  // no triangle of these scenes is larger
    const sim::Vector3d q = p - n * (n.dot(p - a) / n.squaredNorm());
    const bool inside =
        (b - a).cross(q - a).dot(n) >= 0 && (c - b).cross(q - b).dot(n) >= 0 && (a - c).cross(q - c).dot(n) >= 0;
    const double edges = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
    best = std::min(best, inside ? (q - p).norm() : edges);
  }
  return best;
}

TEST_F(Simulate, TruthCarriesEveryScanOntoTheSameSurfaces) {
  for (const std::string orientation : {"yaw", "full", "none"}) {
    SimulateOptions o = options("office", 4, 4);
    o.orientation = orientation;
    o.tilt_deg = 5;
    o.noise_m = o.noise_ppm = o.beam_mrad = 0;
    o.movers = o.glass = false;
    ASSERT_TRUE(simulate(o));
    const sim::Scene scene = sim::build_office({4, sim::default_spacing_m("office"), 1});
    const auto poses = read_poses(fs::path(o.output) / "poses.gt.txt");
    ASSERT_EQ(poses.size(), 4U);
    for (const auto& [name, common_from_scan] : poses) {
      EXPECT_NEAR(common_from_scan.linear().determinant(), 1, 1e-9);
      const io::PointChunk scan = read_points(fs::path(o.output) / name);
      ASSERT_GT(scan.points.size(), 2000U);
      for (std::size_t i = 0; i < scan.points.size(); i += 40) {
        const sim::Vector3d p = common_from_scan * scan.points[i].cast<double>();
        if (scan.points[i].norm() > 30) continue;
        EXPECT_LT(distance_to(scene.mesh, p), 1e-4) << name << " " << i;
      }
    }
  }
}

TEST_F(Simulate, OrientationSaysWhatIsUnknown) {
  const auto rotations = [&](const std::string& orientation) {
    SimulateOptions o = options("tunnel", 2, 10);
    o.orientation = orientation;
    EXPECT_TRUE(simulate(o));
    return read_poses(fs::path(o.output) / "poses.gt.txt");
  };
  for (const auto& [name, pose] : rotations("none")) EXPECT_LT(rotation_angle_rad(pose.linear()), 0.002) << name;
  for (const auto& [name, pose] : rotations("yaw")) {
    EXPECT_GT(rotation_angle_rad(pose.linear()), 0.01) << name;
    EXPECT_GT(pose.linear()(2, 2), 0.99999) << name;
  }
  for (const auto& [name, pose] : rotations("full")) EXPECT_LT(pose.linear()(2, 2), 0.999) << name;
}

TEST_F(Simulate, SameBytesForOneAndTwoThreads) {
  for (const std::string& scene : sim::scene_names()) {
    SimulateOptions o = options(scene, 3, 2);
    o.foreign = 1;
    const auto run = [&](int threads) {
      tbb::task_arena arena(threads);
      const auto summary = arena.execute([&] { return simulate(o); });
      EXPECT_TRUE(summary) << summary.error().text();
      std::map<std::string, std::string> files;
      for (const auto& entry : fs::directory_iterator(o.output))
        files[entry.path().filename()] = read_file(entry.path()).value();
      fs::remove_all(o.output);
      return files;
    };
    const auto one = run(1), two = run(2);
    EXPECT_EQ(one.size(), 7U);
    EXPECT_EQ(one, two) << scene;
  }
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

TEST_F(Simulate, ReplacesItsOwnEarlierScansAndNothingElse) {
  SimulateOptions o = options("tunnel", 4, 10);
  o.foreign = 1;
  ASSERT_TRUE(simulate(o));
  const fs::path folder = o.output;
  fs::create_directories(folder / "out");
  ASSERT_TRUE(write_file_atomically(folder / "notes.txt", "mine"));
  ASSERT_TRUE(write_file_atomically(folder / "scan_900.ply", "mine, too"));
  o.foreign = 0;
  o.stations = 2;
  o.format = "xyz";
  const auto again = simulate(o);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(names_in(folder), (std::set<std::string>{"scan_000.xyz", "scan_001.xyz", "poses.gt.txt", "simulation.yaml",
                                                     "out", "notes.txt", "scan_900.ply"}));
}

TEST_F(Simulate, RefusesAFolderThatHoldsSomethingElse) {
  const SimulateOptions o = options("tunnel", 2, 10);
  fs::create_directories(o.output);
  const std::set<std::string> mine = {"scan_000.ply", "scan_007.ply", "poses.gt.txt"};
  for (const std::string& name : mine) ASSERT_TRUE(write_file_atomically(fs::path(o.output) / name, "measured"));
  const auto refused = simulate(o);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text(), o.output +
                                        ": the folder is not empty and was not made by simulate (name a new "
                                        "folder with -o, or empty this one)");
  EXPECT_EQ(names_in(o.output), mine);
  EXPECT_EQ(read_file(fs::path(o.output) / "scan_000.ply").value(), "measured");
}

TEST_F(Simulate, AHandMadeRecordRemovesNothingOutsideTheFolder) {
  const SimulateOptions o = options("tunnel", 2, 10);
  fs::create_directories(o.output);
  ASSERT_TRUE(write_file_atomically(folder_ / "precious", "x"));
  ASSERT_TRUE(write_file_atomically(fs::path(o.output) / "simulation.yaml", "files:\n  - ../precious\n  - ..\n"));
  EXPECT_TRUE(simulate(o));
  EXPECT_TRUE(fs::exists(folder_ / "precious"));
}

TEST_F(Simulate, ForeignScansAreNamedAndHaveNoPose) {
  SimulateOptions o = options("street", 3, 5);
  o.foreign = 2;
  const auto summary = simulate(o);
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_EQ(summary->scans.size(), 5U);
  const auto poses = read_poses(fs::path(o.output) / "poses.gt.txt");
  EXPECT_EQ(poses.size(), 3U);
  std::istringstream names(read_file(fs::path(o.output) / "foreign.txt").value());
  std::set<std::string> foreign;
  for (std::string name; std::getline(names, name);) foreign.insert(name);
  EXPECT_EQ(foreign.size(), 2U);
  for (const SimulatedScan& scan : summary->scans) {
    EXPECT_EQ(foreign.contains(scan.name), scan.foreign);
    EXPECT_EQ(poses.contains(scan.name), !scan.foreign);
    EXPECT_EQ(read_points(fs::path(o.output) / scan.name).points.size(), scan.num_points);
  }
}

TEST_F(Simulate, MoversDifferFromScanToScanAndCanBeSwitchedOff) {
  SimulateOptions o = options("street", 4, 2);
  const auto with = simulate(o);
  o.movers = false;
  const auto without = simulate(o);
  ASSERT_TRUE(with && without);
  std::set<std::int64_t> changes;
  for (std::size_t k = 0; k < 4; ++k) {
    changes.insert(static_cast<std::int64_t>(with->scans[k].num_points) -
                   static_cast<std::int64_t>(without->scans[k].num_points));
  }
  EXPECT_GT(changes.size(), 1U);
}

TEST_F(Simulate, SpacingMovesTheStationsApart) {
  SimulateOptions o = options("tunnel", 3, 10);
  const auto length = [&](double spacing_m) {
    o.spacing_m = spacing_m;
    EXPECT_TRUE(simulate(o));
    const auto poses = read_poses(fs::path(o.output) / "poses.gt.txt");
    return (poses.rbegin()->second.translation() - poses.begin()->second.translation()).norm();
  };
  EXPECT_NEAR(length(10), 20, 5);
  EXPECT_NEAR(length(40), 80, 20);
}

TEST_F(Simulate, RefusesWhatItCannotDo) {
  const auto error_of = [&](auto change) {
    SimulateOptions o = options("office", 2, 5);
    change(o);
    const auto result = simulate(o);
    return result ? std::string("no error") : result.error().text();
  };
  EXPECT_NE(error_of([](auto& o) { o.scene = "moon"; }).find("moon"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.stations = 0; }).find("stations"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.resolution_deg = std::nan(""); }).find("resolution_deg"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.min_range_m = o.max_range_m = 5; }).find("min_range_m"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.output = ""; }).find("-o"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.output = "/dev/null/x"; }).find("/dev/null/x"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
