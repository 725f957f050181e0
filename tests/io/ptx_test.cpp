#include <cmath>

#include "io/notes.h"
#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Ptx : public IoTest {};

// Turned by 30 degrees about z and moved by (10, 20, 3): row vectors, so the rotation is transposed.
const std::string kPose = "0.866025 0.5 0 0\n-0.5 0.866025 0 0\n0 0 1 0\n10 20 3 1\n";

std::string scan_text(int columns, int rows, const std::string& pose, const std::string& body) {
  return std::to_string(columns) + "\n" + std::to_string(rows) + "\n10 20 3\n1 0 0\n0 1 0\n0 0 1\n" + pose + body;
}

TEST_F(Ptx, ReadsSeveralScansWithPosesAndDropsNoReturns) {
  const auto path =
      write("two scans.ptx",
            scan_text(2, 2, kPose, "1 2 3 0.5 10 20 30\n0 0 0 0.5 0 0 0\n4 5 6 0.25 1 2 3\n0 0 0 0 0 0 0\n") +
                scan_text(1, 2, "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "7 8 9 1 255 0 0\n-1 0 0 1 9 9 9\n\n\n"));
  const auto scans = scans_of_file(path);
  ASSERT_TRUE(scans) << error_of(scans);
  ASSERT_EQ(scans->size(), 2U);
  EXPECT_EQ((*scans)[1].name, "two%20scans.ptx#1");
  const auto first = read_whole((*scans)[0]);
  ASSERT_TRUE(first) << error_of(first);
  EXPECT_EQ(first->header.num_points, 4U);
  ASSERT_EQ(first->p_in_scan.size(), 2U);
  expect_near(first->p_in_scan[1], {4, 5, 6}, 0);
  EXPECT_EQ(first->chunk.intensity[1], 0.25F);
  EXPECT_EQ(first->chunk.colour[0], (std::array<std::uint8_t, 3>{10, 20, 30}));
  ASSERT_TRUE(first->header.station_in_scan && first->header.file_from_scan);
  expect_near(*first->header.station_in_scan, Eigen::Vector3d::Zero(), 0);
  const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
  expect_near(*first->header.file_from_scan * Eigen::Vector3d(1, 2, 3), {10 + c - 2 * s, 20 + s + 2 * c, 6}, 1e-5);
  EXPECT_NE(first->header.notes.back().find("2 no-return lines"), std::string::npos);
  for (const std::string& note : first->header.notes) EXPECT_TRUE(is_matter_of_course(note)) << note;
  for (const ScanRef& ref : {(*scans)[1], ScanRef{path, 1, {}}}) {  // with and without the place known
    const auto second = read_whole(ref);
    ASSERT_TRUE(second) << error_of(second);
    ASSERT_EQ(second->p_in_scan.size(), 2U);
    expect_near(second->p_in_scan[0], {7, 8, 9}, 0);
  }
  EXPECT_NE(error_of(read_whole(ScanRef{path, 2, {}})).find("the file holds 2 scans, there is no #2"),
            std::string::npos);
}

TEST_F(Ptx, AMatrixThatIsNotRigidIsNoPose) {
  const auto scan = read_whole(write("a.ptx", scan_text(1, 1, "1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n", "1 2 3 0.5\n")));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_FALSE(scan->header.file_from_scan.has_value());
}

TEST_F(Ptx, PointsInTheMapFrameAreShiftedAndHaveNoStation) {
  const auto scan = read_whole(
      write("a.ptx", scan_text(1, 2, kPose, "500000.1234 5240000.5678 3 0.5\n500001.1234 5240000.5678 3 0.5\n")));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_FALSE(scan->header.station_in_scan.has_value());
  expect_near(scan->p_in_scan[0], {500000.1234, 5240000.5678, 3}, 1e-4);
}

TEST_F(Ptx, ADamagedPartCostsOnlyItsOwnScan) {
  const std::string good = scan_text(1, 2, kPose, "1 2 3 0.5\n4 5 6 0.5\n");
  const auto cut = write("cut.ptx", good + scan_text(2, 2, kPose, "1 2 3 0.5\n4 5 6 0.5\n7 8"));
  auto scans = scans_of_file(cut);
  ASSERT_TRUE(scans && scans->size() == 2U);
  EXPECT_TRUE(read_whole((*scans)[0]));
  EXPECT_NE(error_of(read_whole((*scans)[1])).find("line 25: the last line is no whole point: '7 8'"),
            std::string::npos)
      << error_of(read_whole((*scans)[1]));
  scans = scans_of_file(write("fewer.ptx", good + scan_text(3, 2, kPose, "1 2 3 0.5\n4 5 6 0.5\n")));
  ASSERT_TRUE(scans && scans->size() == 2U);
  EXPECT_NE(error_of(read_whole((*scans)[1])).find("the header says 6 points, the file holds 2"), std::string::npos);
  scans = scans_of_file(write("garbage.ptx", good + "what is this\n"));
  ASSERT_TRUE(scans && scans->size() == 2U);
  EXPECT_TRUE(read_whole((*scans)[0]));
  EXPECT_NE(
      error_of(read_whole((*scans)[1])).find("line 13: PTX header: the number of columns expected, not 'what is this'"),
      std::string::npos);
}

TEST_F(Ptx, HugeGridsAreRefused) {
  const auto huge =
      read_whole(write("a.ptx", "4000000000\n4000000000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + kPose + "1 2 3 0.5\n"));
  EXPECT_NE(error_of(huge).find("the header says 16000000000000000000 points"), std::string::npos) << error_of(huge);
  EXPECT_NE(error_of(read_whole(write("b.ptx", "1e300\n1\n"))).find("the number of columns cannot be"),
            std::string::npos);
  EXPECT_NE(error_of(read_whole(write("c.ptx", "-3\n1\n"))).find("the number of columns cannot be -3"),
            std::string::npos);
  EXPECT_NE(error_of(read_whole(write("d.ptx", "3\n"))).find("the file ends inside a PTX header"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
