// The same scans in another format are the same survey. On real scans: shared_formats_test.cpp.
#include <algorithm>
#include <fstream>

#include "end_to_end/converted_survey.h"

namespace isthmus::testing {
namespace {

using Formats = ConvertedSurvey;

int pairs_of_first_round(const fs::path& links) {
  std::ifstream file(links);
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    return cells;
  };
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> columns = cells_of(line);
  const auto at = std::ranges::find(columns, "first_round") - columns.begin();
  int count = 0;
  while (std::getline(file, line)) count += cells_of(line).at(static_cast<std::size_t>(at)) == "1";
  return count;
}

TEST_F(Formats, pcd_and_e57_of_floats_give_the_same_bytes) {
  make_survey(3);
  poses_of(converted(scans_, "pcd"), folder_ / "out_pcd");
  poses_of(converted(scans_, "e57"), folder_ / "out_e57");
  std::string poses = text_of_file(folder_ / "out_pcd/poses.txt");
  for (std::size_t at = 0; (at = poses.find(".pcd")) != std::string::npos;) poses.replace(at, 4, ".e57");
  EXPECT_EQ(poses, text_of_file(folder_ / "out_e57/poses.txt"));
  EXPECT_EQ(text_of_file(folder_ / "out_pcd/pose_graph.g2o"), text_of_file(folder_ / "out_e57/pose_graph.g2o"));
}

TEST_F(Formats, e57_comes_back_with_the_points_as_they_were_and_the_poses_that_were_found) {
  make_survey(3);
  const fs::path e57 = folder_ / "one";
  fs::create_directories(e57);
  auto writer = io::E57Writer::create(e57 / "all.e57");
  ASSERT_TRUE(writer);
  for (const io::ScanRef& scan : scans_in(scans_)) {
    const PointChunk points = whole_scan(scan);
    ASSERT_TRUE(writer->begin_scan({scan.name, {}, {}, false, !points.intensity.empty(), !points.colour.empty()}));
    ASSERT_TRUE(writer->add(points));
  }
  ASSERT_TRUE(writer->publish());
  const std::vector<Transform> poses = poses_of(e57, out_);
  ASSERT_EQ(poses.size(), 3U);

  const fs::path registered = folder_ / "registered.e57";
  const Said said = run({"export", out_.string(), "--e57", registered.string()});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  const auto before = io::scans_of_file(e57 / "all.e57"), after = io::scans_of_file(registered);
  ASSERT_TRUE(before && after);
  ASSERT_EQ(after->size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const PointChunk a = whole_scan((*before)[k]), b = whole_scan((*after)[k]);
    ASSERT_GT(a.points.size(), 10000U);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.intensity, b.intensity);
    const auto reader = io::open_scan((*after)[k]);
    ASSERT_TRUE(reader && (*reader)->header().file_from_scan);
    EXPECT_LT(((*reader)->header().file_from_scan->matrix() - poses[k].matrix()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Far positions are not tried, so that which pairs were tried tells what was believed; where the scans lie, it does
// not.
TEST_F(Formats, positions_that_files_store_choose_pairs_and_place_no_scan) {
  make_survey(4);
  std::vector<Transform> stored(4, Transform::Identity());
  for (int k = 0; k < 4; ++k) stored[static_cast<std::size_t>(k)].translation() = Eigen::Vector3d(7, 10.0 * k, 0);
  const fs::path ptx = in_one_ptx(scans_, stored);
  const auto first_round_with = [&](const std::string& file_positions) {
    const Said said = run({"register", ptx.string(), "-o", (folder_ / "with").string(), "--set",
                           "candidates.max_distance_m=12", "--set", "candidates.file_positions=" + file_positions});
    EXPECT_EQ(said.err.find("store a position") != std::string::npos, file_positions == "true") << said.err;
    return pairs_of_first_round(folder_ / "with/links.csv");
  };
  EXPECT_EQ(first_round_with("false"), 6);
  EXPECT_EQ(first_round_with("true"), 3) << "only neighbours are nearer than 12 m";
  expect_same_poses(poses_of(scans_, out_), poses_of(ptx, folder_ / "with"), Eigen::Vector3d::Zero());
}

TEST_F(Formats, las_in_map_coordinates_with_its_stations_is_the_same_survey) {
  make_survey(3);
  const fs::path las = in_map_coordinates(scans_);
  const std::string stations = "sampling.stations=" + (folder_ / "stations.csv").string();
  const std::vector<Transform> poses = poses_of(las, folder_ / "out_las", {"--set", stations});
  expect_same_poses(poses_of(scans_, out_), poses, station_in_map_);
  const std::string scans = text_of_file(folder_ / "out_las/scans.csv");
  EXPECT_EQ(scans.find("station unknown"), std::string::npos) << scans;

  // Another station is another survey: nothing of a scan that was reduced without it is taken from the store.
  const Said without = run({"register", las.string(), "-o", (folder_ / "out_las").string()});
  EXPECT_NE(without.err.find("station unknown"), std::string::npos) << without.err;
}

TEST_F(Formats, a_list_of_stations_that_cannot_be_read_ends_the_run_before_it_begins) {
  make_survey(2);
  std::ofstream(folder_ / "stations.csv") << "scan,x,y\nscan_000,1,2\n";
  const Said said = register_scans({"--set", "sampling.stations=" + (folder_ / "stations.csv").string()});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find("no column 'z'"), std::string::npos) << said.err;
}

}  // namespace
}  // namespace isthmus::testing
