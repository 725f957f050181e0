#include "io/e57/e57_writer.h"

#include <fstream>

#include "base/rng.h"
#include "e57_testing.h"
#include "io/e57/e57_poses.h"
#include "io/inspect.h"
#include "io/scan_writer.h"
#include "shared_data.h"

namespace isthmus::io::testing {
namespace {

class E57Writing : public IoTest {
 protected:
  static std::string bytes_of_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

PointChunk random_points(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  PointChunk chunk;
  for (std::size_t i = 0; i < n; ++i) {
    const auto next = [&] { return static_cast<float>(rng.uniform(-80.0, 80.0)); };
    chunk.points.emplace_back(next(), next(), next());
    chunk.intensity.push_back(static_cast<float>(rng.uniform()));
    const auto byte = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
    chunk.colour.push_back({byte(), byte(), byte()});
  }
  return chunk;
}

Transform some_pose(double angle_rad, const Eigen::Vector3d& translation) {
  Transform pose = Transform::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d(0.1, -0.2, 1).normalized()).toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

TEST_F(E57Writing, WhatIsWrittenIsReadBackBitForBit) {
  const auto path = folder / "a.e57";
  const Transform pose = some_pose(2.5, {100.25, -7, 3.125});
  const PointChunk large = random_points(20000, 1), small = random_points(3, 2);
  {
    auto writer = E57Writer::create(path);
    ASSERT_TRUE(writer) << error_of(writer);
    ASSERT_TRUE(writer->begin_scan({"station ä ]]> <1>", "{own}", pose, false, true, true}));
    ASSERT_TRUE(writer->add(large));
    ASSERT_TRUE(writer->add(small));
    ASSERT_TRUE(writer->begin_scan({"nothing", {}, {}, false, false, false}));
    ASSERT_TRUE(writer->begin_scan({"bare", {}, {}, false, false, false}));
    ASSERT_TRUE(writer->add(small));
    EXPECT_FALSE(std::filesystem::exists(path));
    ASSERT_TRUE(writer->publish());
  }
  const auto scans = scans_of_file(path);
  ASSERT_TRUE(scans) << error_of(scans);
  ASSERT_EQ(scans->size(), 3U);
  const auto first = read_whole((*scans)[0], 4096);
  ASSERT_TRUE(first) << error_of(first);
  ASSERT_EQ(first->chunk.points.size(), 20003U);
  EXPECT_TRUE(std::equal(large.points.begin(), large.points.end(), first->chunk.points.begin()));
  EXPECT_TRUE(std::equal(large.intensity.begin(), large.intensity.end(), first->chunk.intensity.begin()));
  EXPECT_TRUE(std::equal(large.colour.begin(), large.colour.end(), first->chunk.colour.begin()));
  EXPECT_EQ(first->chunk.points.back(), small.points.back());
  ASSERT_TRUE(first->header.file_from_scan.has_value());
  EXPECT_TRUE(first->header.file_from_scan->isApprox(pose, 1e-15));
  EXPECT_NE(first->header.notes[0].find("name 'station \\xc3\\xa4 ]]> <1>'"), std::string::npos)
      << first->header.notes[0];
  EXPECT_NE(error_of(read_whole((*scans)[1])).find("holds no points"), std::string::npos);
  const auto bare = read_whole((*scans)[2]);
  ASSERT_TRUE(bare) << error_of(bare);
  EXPECT_EQ(bare->chunk.points, small.points);
  EXPECT_TRUE(bare->chunk.intensity.empty() && bare->chunk.colour.empty());
  EXPECT_FALSE(bare->header.file_from_scan.has_value());
  const std::string bytes = bytes_of_file(path);  // every page, by the slow twin
  EXPECT_EQ(paged(unpaged(bytes)), bytes);
}

TEST_F(E57Writing, DoublesKeepMapCoordinatesAndTheBytesDependOnTheContentAlone) {
  const PointChunk points = random_points(50, 3);
  const Eigen::Vector3d origin(500000, 5240000, 0);
  for (const char* name : {"a.e57", "b.e57"}) {
    auto writer = E57Writer::create(folder / name);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->begin_scan({"s", {}, {}, true, false, false}));
    ASSERT_TRUE(writer->add(points, origin));
    ASSERT_TRUE(writer->publish());
  }
  EXPECT_EQ(bytes_of_file(folder / "a.e57"), bytes_of_file(folder / "b.e57"));
  const auto scan = read_whole(folder / "a.e57");
  ASSERT_TRUE(scan) << error_of(scan);
  for (std::size_t i = 0; i < 50; ++i) expect_near(scan->p_in_scan[i], points.points[i].cast<double>() + origin, 1e-5);
}

TEST_F(E57Writing, WrongArraysAreRefusedAndNothingIsLeftBehind) {
  auto writer = E57Writer::create(folder / "a.e57");
  ASSERT_TRUE(writer);
  PointChunk points = random_points(2, 1);
  EXPECT_NE(error_of(writer->add(points)).find("not what was announced"), std::string::npos);
  ASSERT_TRUE(writer->begin_scan({"s", {}, {}, false, true, false}));
  points.intensity.pop_back();
  EXPECT_NE(error_of(writer->add(points)).find("not what was announced"), std::string::npos);
  writer = tl::unexpected(Error{});
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_NE(error_of(E57Writer::create(folder / "missing" / "a.e57")).find("cannot be created"), std::string::npos);
}

TEST_F(E57Writing, ScansAreWrittenByExtension) {
  const PointChunk points = random_points(1000, 9);
  ASSERT_TRUE(write_scan(folder / "a.e57", points));
  const auto scan = read_whole(folder / "a.e57");
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->chunk.points, points.points);
  EXPECT_EQ(scan->chunk.intensity, points.intensity);
  EXPECT_EQ(scan->chunk.colour, points.colour);
}

const std::string kPoseXml =
    R"(<pose type="Structure"><translation type="Structure"><x type="Float">1</x><y type="Float">2</y><z type="Float">3</z></translation></pose>)";

TEST_F(E57Writing, PosesAreReplacedWhileThePointsStayBitForBit) {
  HandMadeE57 e57;
  const std::vector<double> many(4000, 1.25);
  const auto packet = data_packet({raw_bytes<float>(std::vector<float>(2000, 1.0F)), raw_bytes(many), raw_bytes(many)});
  e57.add_scan(
      2000, field_xml("cartesianX", R"(type="Float" precision="single")") + doubles_xml({"cartesianY", "cartesianZ"}),
      data_packet({raw_bytes<float>(std::vector<float>(2000, 1.0F)), raw_bytes(std::vector<double>(2000, 1.25)),
                   raw_bytes(std::vector<double>(2000, 2.5))}),
      "<guid type=\"String\"><![CDATA[{one}]]></guid><!-- a remark --><vendor:thing xmlns:vendor=\"urn:v\" "
      "type=\"String\">a &amp; b &lt; c</vendor:thing>" +
          kPoseXml);
  e57.add_scan(1, doubles_xml(kXyz),
               data_packet({raw_bytes<double>({1}), raw_bytes<double>({2}), raw_bytes<double>({3})}));
  e57.add_scan(1, doubles_xml(kXyz),
               data_packet({raw_bytes<double>({4}), raw_bytes<double>({5}), raw_bytes<double>({6})}), kPoseXml);
  e57.more_xml =
      "<images2D type=\"Vector\"><vectorChild type=\"Structure\"><associatedData3DGuid type=\"String\">{one}"
      "</associatedData3DGuid>" +
      kPoseXml + "</vectorChild></images2D>";
  const auto from = write("a.e57", e57.file());
  const Transform first = some_pose(1.0, {10, 20, 30}), second = some_pose(-3.0, {0.1, 0.2, 1e-7});
  const auto to = folder / "b.e57";
  const auto copied = copy_e57_with_poses(from, to, {first, second, std::nullopt});
  ASSERT_TRUE(copied) << error_of(copied);
  const std::string before = unpaged(bytes_of_file(from)), bytes = bytes_of_file(to), after = unpaged(bytes);
  EXPECT_EQ(paged(after), bytes);
  EXPECT_EQ(before.substr(48, e57.logical.size() - 48), after.substr(48, e57.logical.size() - 48));
  EXPECT_NE(after.find("a &amp; b &lt; c</vendor:thing>"), std::string::npos);
  EXPECT_NE(after.find("<!-- a remark -->"), std::string::npos);
  EXPECT_EQ(after.find("[CDATA[{f}]]"), std::string::npos);  // another file has another guid
  for (int k = 0; k < 3; ++k) {
    const auto old_scan = read_whole(ScanRef{from, k, {}}), new_scan = read_whole(ScanRef{to, k, {}});
    ASSERT_TRUE(old_scan && new_scan) << error_of(new_scan);
    EXPECT_EQ(old_scan->chunk.points, new_scan->chunk.points);
    const Transform expected = k == 0 ? first : k == 1 ? second : Transform(Eigen::Translation3d(1, 2, 3));
    ASSERT_TRUE(new_scan->header.file_from_scan.has_value());
    EXPECT_TRUE(new_scan->header.file_from_scan->isApprox(expected, 1e-14)) << k;
  }
  // The image stood where the scanner stood, and still does.
  const std::size_t image = after.find("images2D");
  EXPECT_NE(after.find("<x type=\"Float\">10</x>", image), std::string::npos) << after.substr(image, 1000);
  const auto fewer = folder / "fewer.e57";
  ASSERT_TRUE(copy_e57_with_poses(from, fewer, {std::nullopt, second, std::nullopt}, ScansWithoutPose::left_out));
  ASSERT_EQ(scans_of_file(fewer)->size(), 1U);
  EXPECT_EQ(read_whole(fewer)->p_in_scan[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(bytes_of_file(fewer).find("associatedData3DGuid"), std::string::npos);  // its scan is not there
  ASSERT_TRUE(copy_e57_with_poses(to, to, {first, second, std::nullopt}));
  EXPECT_TRUE(read_whole(ScanRef{to, 2, {}}));
  EXPECT_NE(error_of(copy_e57_with_poses(from, to, {first})).find("1 poses for 3 scans"), std::string::npos);
  std::string damaged = bytes_of_file(from);
  damaged[3000] ^= 1;
  const auto bad = write("c.e57", damaged);
  EXPECT_NE(error_of(copy_e57_with_poses(bad, folder / "d.e57", {first, second, first})).find("page 2 is damaged"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "d.e57"));
}

TEST_F(E57Writing, PosesAreReplacedWhereTheXmlStandsBeforeThePoints) {
  HandMadeE57 e57;
  e57.logical.resize(1500);  // room for the XML
  e57.add_scan(1, doubles_xml(kXyz),
               data_packet({raw_bytes<double>({1}), raw_bytes<double>({2}), raw_bytes<double>({3})}));
  const auto path = write("a.e57", e57.file(100));
  const Transform pose = some_pose(0.5, {1, 2, 3});
  const auto copied = copy_e57_with_poses(path, folder / "b.e57", {pose});
  ASSERT_TRUE(copied) << error_of(copied);
  const auto scan = read_whole(folder / "b.e57");
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->p_in_scan[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(scan->header.file_from_scan->isApprox(pose, 1e-15));
}

TEST_F(E57Writing, FilesOfOtherProgramsKeepTheirPointsUnderNewPoses) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  for (const char* name : {"e57_libe57format/bunnyInt32.e57", "e57_libe57format/ColouredCubeFloat.e57",
                           "e57_libe57format/ColourRepresentation.e57", "e57_pye57/testWithNormals.e57",
                           "e57_pye57/translationWithoutRotation.e57"}) {
    const auto from = data / "formats" / name, to = folder / "copy.e57";
    const Transform pose = some_pose(1.0, {1, 2, 3});
    const auto copied = copy_e57_with_poses(from, to, {pose});
    ASSERT_TRUE(copied) << error_of(copied);
    const auto before = read_whole(ScanRef{from, 0, {}}, 5000), after = read_whole(ScanRef{to, 0, {}}, 5000);
    ASSERT_TRUE(before && after) << error_of(after);
    EXPECT_EQ(before->chunk.points, after->chunk.points);
    EXPECT_EQ(before->chunk.colour, after->chunk.colour);
    EXPECT_TRUE(after->header.file_from_scan->isApprox(pose, 1e-15));
  }
}

TEST_F(E57Writing, TheSameScanAsDoublesAndAsIntegersIsTheSame) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  const auto folder_of = data / "formats" / "e57_libe57format";
  const auto doubles = read_whole(ScanRef{folder_of / "bunnyDouble.e57", 0, {}}, 5000);
  const auto integers = read_whole(ScanRef{folder_of / "bunnyInt32.e57", 0, {}}, 5000);
  ASSERT_TRUE(doubles && integers);
  ASSERT_EQ(doubles->p_in_scan.size(), integers->p_in_scan.size());
  for (std::size_t i = 0; i < doubles->p_in_scan.size(); ++i) {
    expect_near(doubles->p_in_scan[i], integers->p_in_scan[i], 6e-7);  // half the step of the integers
  }
}

}  // namespace
}  // namespace isthmus::io::testing
