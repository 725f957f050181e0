#include "pipelines/scan_positions.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "base/temporary_folder.h"

namespace isthmus::pipelines {
namespace {

class ScanPositionsFile : public ::testing::Test {
 protected:
  Result<ScanPositions> read(const std::string& text) {
    std::ofstream(folder_ / "positions.csv") << text;
    return read_positions((folder_ / "positions.csv").string(), names_);
  }
  std::string error_of(const std::string& text) {
    const auto positions = read(text);
    return positions ? "" : positions.error().text();
  }

  testing::TemporaryFolder folder_;
  const std::array<std::string, 3> names_ = {"floor1/a.ply", "floor1/b.ply", "my%20yard.e57#1"};
};

TEST_F(ScanPositionsFile, columns_stand_in_any_order_and_scans_are_named_as_people_name_them) {
  const auto positions =
      read("x,y,z,scan,remark\n# measured by tape\n1,2,3,floor1/a.ply,near the stairs\n4.5,-6,0.5, b ,\n");
  ASSERT_TRUE(positions) << positions.error().text();
  EXPECT_TRUE(positions->warnings.empty());
  ASSERT_EQ(positions->by_name.size(), 2U);
  EXPECT_EQ(positions->by_name.at("floor1/a.ply"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(positions->by_name.at("floor1/b.ply"), Eigen::Vector3d(4.5, -6, 0.5));
}

TEST_F(ScanPositionsFile, heights_may_be_missing_and_rows_of_other_scans_only_warn) {
  const auto positions = read("scan,x,y\na,1,2\nc.ply,3,4\n");
  ASSERT_TRUE(positions) << positions.error().text();
  EXPECT_EQ(positions->by_name.at("floor1/a.ply"), Eigen::Vector3d(1, 2, 0));
  ASSERT_EQ(positions->warnings.size(), 1U);
  EXPECT_NE(positions->warnings[0].find("positions.csv:3"), std::string::npos) << positions->warnings[0];
  EXPECT_NE(positions->warnings[0].find("'c.ply'"), std::string::npos) << positions->warnings[0];
}

TEST_F(ScanPositionsFile, errors_name_line_and_value) {
  EXPECT_NE(error_of("scan,x\na,1\n").find("no column 'y'"), std::string::npos);
  EXPECT_NE(error_of("scan,x,y\na,1,two\n").find("positions.csv:2: 'two' under y"), std::string::npos)
      << error_of("scan,x,y\na,1,two\n");
  EXPECT_NE(error_of("scan,x,y\na,1,inf\n").find("not a finite number"), std::string::npos);
  EXPECT_NE(error_of("scan,x,y\na,1\n").find("2 fields"), std::string::npos);
  EXPECT_NE(error_of("scan,x,y\na,1,2\na.ply,3,4\n").find("second position"), std::string::npos);
  EXPECT_NE(error_of("").find("no positions"), std::string::npos);
  EXPECT_FALSE(read_positions((folder_ / "missing.csv").string(), names_));
}

TEST_F(ScanPositionsFile, stations_have_heights) {
  const std::string file = (folder_ / "stations.csv").string();
  std::ofstream(file) << "scan,x,y,z\nb,512345.678,5243210.987,432.1\n";
  const auto stations = read_stations(file, names_);
  ASSERT_TRUE(stations) << stations.error().text();
  EXPECT_EQ(stations->by_name.at("floor1/b.ply"), Eigen::Vector3d(512345.678, 5243210.987, 432.1));
  std::ofstream(file) << "scan,x,y\nb,1,2\n";
  const auto flat = read_stations(file, names_);
  ASSERT_FALSE(flat);
  EXPECT_NE(flat.error().text().find("no column 'z'"), std::string::npos) << flat.error().text();
}

TEST(PositionsOfFiles, are_those_that_tell_stations_apart) {
  using Stored = std::vector<std::pair<std::string, std::optional<Eigen::Vector3d>>>;
  const Eigen::Vector3d far(512345.6, 5243210.9, 432.1), origin(0, 0, 0);
  const auto found = positions_of_files(
      Stored{{"a", far}, {"b", far + Eigen::Vector3d(3, 0, 0)}, {"c", std::nullopt}, {"d", origin}, {"e", origin}});
  ASSERT_EQ(found.by_name.size(), 2U) << "no pose, or that of several at the origin, is no position";
  EXPECT_EQ(positions_of_files(Stored{{"a", Eigen::Vector3d(4, 0, 0)}, {"b", origin}}).by_name.size(), 2U)
      << "the reference station";
  EXPECT_EQ(found.by_name.at("a"), far);
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_TRUE(positions_of_files(Stored{{"a", far}, {"b", far + Eigen::Vector3d(0.5, 0, 0)}}).by_name.empty())
      << "all at one place";
  EXPECT_TRUE(positions_of_files(Stored{{"a", origin}, {"b", origin}}).by_name.empty());
  EXPECT_TRUE(positions_of_files(Stored{{"a", far}}).by_name.empty());
  EXPECT_TRUE(positions_of_files(Stored{}).by_name.empty());
}

TEST_F(ScanPositionsFile, no_file_is_no_positions) {
  const auto positions = read_positions("", names_);
  ASSERT_TRUE(positions);
  EXPECT_TRUE(positions->by_name.empty());
}

}  // namespace
}  // namespace isthmus::pipelines
