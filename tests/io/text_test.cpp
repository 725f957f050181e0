#include <cmath>

#include "io/notes.h"
#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

class Text : public IoTest {
 protected:
  Result<WholeScan> read(const std::string& name, const std::string& text) const {
    return read_whole(write(name, text));
  }
  std::string error(const std::string& name, const std::string& text) const { return error_of(read(name, text)); }
};

TEST_F(Text, DelimitersAndColumnsAreFoundAndStated) {
  struct Case {
    const char* text;
    const char* note;
  };
  const Case cases[] = {
      {"1 2 3\n4 5 6\n", "columns x y z, delimiter blank by their values"},
      {"1\t2\t3\t0.5\n4\t5\t6\t0.25\n", "columns x y z intensity, delimiter blank by their values"},
      {"1,2,3,0.5,255,0,7\n4, 5, 6, 0.25, 1, 2, 3\n",
       "columns x y z intensity red green blue, delimiter ',' by their values"},
      {"1;2;3;10;20;30\n4;5;6;40;50;60\n", "columns x y z red green blue, delimiter ';' by their values"},
      {"1 2 3 0.6 0.8 0\n4 5 6 0 0 -1\n", "columns x y z, delimiter blank (nx ny nz not used) by their values"},
      {"1 2 3 10 20 30 255\n4 5 6 9 9 9 255\n", "columns x y z red green blue, delimiter blank by their values"},
      {"id,X,Y,Z,Intensity\na,1,2,3,9\nb,4,5,6,8\n", "columns - x y z intensity, delimiter ',' by their names"},
  };
  for (const Case& c : cases) {
    const auto scan = read("a.txt", c.text);
    ASSERT_TRUE(scan) << error_of(scan);
    EXPECT_EQ(scan->header.notes[0], c.note);
    EXPECT_TRUE(is_matter_of_course(scan->header.notes[0])) << c.note;
    ASSERT_EQ(scan->p_in_scan.size(), 2U);
    expect_near(scan->p_in_scan[0], {1, 2, 3}, 0);
    expect_near(scan->p_in_scan[1], {4, 5, 6}, 0);
  }
}

TEST_F(Text, NamedColumnsMayStandAnywhere) {
  const auto scan =
      read("a.csv", "\xEF\xBB\xBF\"time\",\"Z\",\"Intensity\",\"X\",\"Y\",R,G,B\r\n0.1,3,7,1,2,1.0,0,0.5\r\n");
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 1U);
  expect_near(scan->p_in_scan[0], {1, 2, 3}, 0);
  EXPECT_EQ(scan->chunk.intensity[0], 7.0F);
  EXPECT_EQ(scan->chunk.colour[0], (std::array<std::uint8_t, 3>{255, 0, 128}));
  const auto comment = read("b.txt", "//X Y Z Nx Intensity\n1 2 3 9 5\n");
  ASSERT_TRUE(comment) << error_of(comment);
  EXPECT_EQ(comment->chunk.intensity[0], 5.0F);
  const auto map = read("c.txt", "Easting Northing Height\n1 2 3\n");
  ASSERT_TRUE(map) << error_of(map);
}

TEST_F(Text, CommentsBlankLinesCrLfTitlesAndNan) {
  const auto scan = read(
      "a.xyz", "# made by hand\r\nMy survey of the barn\r\n\r\n1 2 3\r\n# between\r\n\r\nnan nan nan\r\n  +4 5e0 .6e1");
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 3U);
  EXPECT_TRUE(std::isnan(scan->p_in_scan[1].y()));
  expect_near(scan->p_in_scan[2], {4, 5, 6}, 0);
  EXPECT_NE(scan->header.notes[0].find("title line 'My survey of the barn' skipped"), std::string::npos);
}

TEST_F(Text, PtsCountsItsPoints) {
  const auto scan = read("a.pts", "2\n1 2 3 -900 10 20 30\n4 5 6 100 1 2 3\n7 8 9 0 0 0 0\n");
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->header.format, "pts");
  EXPECT_EQ(scan->header.num_points, 2U);
  EXPECT_EQ(scan->p_in_scan.size(), 2U);
  EXPECT_EQ(scan->chunk.intensity[0], -900.0F);
  EXPECT_NE(scan->header.notes.back().find("goes on behind the 2 points"), std::string::npos);
  EXPECT_FALSE(is_matter_of_course(scan->header.notes.back()));
  EXPECT_FALSE(scan->header.station_in_scan.has_value());
  EXPECT_NE(error("b.pts", "3\n1 2 3\n4 5 6\n").find("the header says 3 points, the file holds 2"), std::string::npos);
  EXPECT_NE(error("c.pts", "18446744073709551615\n1 2 3\n").find("the header says 18446744073709551615"),
            std::string::npos);
}

TEST_F(Text, ErrorsNameTheLineAndShowIt) {
  EXPECT_NE(error("a.xyz", "1 2 3\n4 five 6\n7 8 9\n").find("a.xyz, line 2: this line is no point: '4 five 6'"),
            std::string::npos);
  EXPECT_NE(error("a.xyz", "1 2 3\n4 5").find("line 2: the last line is no whole point: '4 5'"), std::string::npos);
  EXPECT_NE(error("a.xyz", "1,5;2,5;3,5\n").find("decimal commas"), std::string::npos);
  EXPECT_NE(error("a.txt", "Only prose here.\nNothing else.\n").find("no line with a point found"), std::string::npos);
  EXPECT_NE(error("a.csv", "id,name,points\n1,2,3\n").find("no columns x y z among 'id name points'"),
            std::string::npos);
  EXPECT_NE(error("a.csv", "x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n").find("a table of poses"), std::string::npos);
  EXPECT_NE(error("a.csv", "x,y,height above\n1,2,3\n").find("columns x y z are not all there"), std::string::npos);
  EXPECT_NE(error("a.xyz", std::string("1 2 3\n4 5 6\0 7\n", 15)).find("zero byte"), std::string::npos);
  EXPECT_NE(error("a.xyz", "1 2 3\n" + std::string(3 << 20, '7')).find("longer than 1 MiB"), std::string::npos);
  EXPECT_NE(error("a.xyz", "").find("the file is empty"), std::string::npos);
}

TEST_F(Text, MapCoordinatesLoseNothing) {
  const auto scan =
      read("a.xyz", "0 0 0\n500123.4567 5240987.6543 431.1\n500123.4577 5240987.6553 431.1\n500125 5240980 430\n");
  ASSERT_TRUE(scan) << error_of(scan);
  expect_near(scan->header.local_origin_in_scan, {500100, 5241000, 0}, 0);
  expect_near(scan->p_in_scan[1], {500123.4567, 5240987.6543, 431.1}, 1e-4);
  expect_near(scan->p_in_scan[2] - scan->p_in_scan[1], {0.001, 0.001, 0}, 1e-5);
}

TEST_F(Text, ObjVerticesWithAndWithoutColour) {
  const auto scan = read("a.obj", "# o\nmtllib a\nvn 0 0 1\nv 1 2 3 1 0.5 0\n  v 4 5 6 0 0 0\nf 1 2 1\nvt 0 0\n");
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 2U);
  EXPECT_EQ(scan->chunk.colour[0], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_NE(error("b.obj", "# nothing\nf 1 2 3\n").find("holds no points"), std::string::npos);
  EXPECT_NE(error("c.obj", "v 1 2 3\nv 1 2\nv 4 5 6\n").find("line 2: this line is no point"), std::string::npos);
}

TEST_F(Text, ThreeDtkBecomesMetricAndRightHanded) {
  const auto scan = read("a.3d", "100 200 300 0.5\n-10.5 0 0 1\n");  // right, up, forward in cm
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->header.format, "3dtk");
  expect_near(scan->p_in_scan[0], {3, -1, 2}, 1e-6);  // forward, left, up in m
  expect_near(scan->p_in_scan[1], {0, 0.105, 0}, 1e-6);
}

class Kitti : public IoTest {};

TEST_F(Kitti, ReadsFourFloatsAPoint) {
  std::string bytes;
  for (int i = 0; i < 100; ++i) {
    for (const float v : {1.0F * static_cast<float>(i), 2.0F, -1.5F, 0.25F}) bytes += bytes_of_value(v);
  }
  const auto scan = read_whole(write("a.bin", bytes));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->header.num_points, 100U);
  expect_near(scan->p_in_scan[99], {99, 2, -1.5}, 0);
  EXPECT_EQ(scan->chunk.intensity[5], 0.25F);
  EXPECT_NE(error_of(read_whole(write("b.bin", bytes.substr(1)))).find("1599 bytes are no multiple of 16"),
            std::string::npos);
  EXPECT_NE(error_of(read_whole(write("c.bin", std::string(1600, '\x7F')))).find("no coordinates"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
