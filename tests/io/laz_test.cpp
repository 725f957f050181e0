// Compressed LAS; in builds without LASzip, what is said instead.
#include "io/las/laz.h"

#include "base/rng.h"
#ifdef ISTHMUS_HAS_LASZIP
#include "io/las/laszip_handle.h"
#endif
#include "io/cloud_writer.h"
#include "io/format_table.h"
#include "io_testing.h"

#include <fmt/format.h>

namespace isthmus::io::testing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoints = 120'000;  // three chunks, the last one not full
constexpr std::size_t kHeaderBytes = 375;

std::vector<CloudPoint> points_on_a_map() {
  Rng rng(3);
  std::vector<CloudPoint> points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    points[i].position = {500'000 + 1e-3 * static_cast<double>(i), 5'000'000 + 50 * rng.uniform(), 10 * rng.uniform()};
    points[i].intensity = static_cast<float>(i % 65536);
    points[i].colour = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 256), 7};
    points[i].source = static_cast<std::uint16_t>(1 + i / 1000);
  }
  return points;
}

class Laz : public IoTest {
 protected:
  void SetUp() override {
    IoTest::SetUp();
    if (!has_laz()) GTEST_SKIP() << "this build has no LASzip";
  }
  fs::path write_cloud(const std::string& name, bool colour, const std::optional<Crs>& crs = {},
                       std::size_t count = kPoints) const {
    CloudShape shape{true, colour, {500'000, 5'000'000, 0}, crs};
    auto writer = CloudWriter::create(folder / name, shape);
    EXPECT_TRUE(writer) << error_of(writer);
    const std::vector<CloudPoint> points = points_on_a_map();
    for (std::size_t i = 0; writer && i < count; ++i) EXPECT_TRUE(writer->add(points[i]));
    EXPECT_TRUE(writer && writer->publish());
    return folder / name;
  }
  static std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

Result<WholeScan> whole(const fs::path& path) { return read_whole(ScanRef{path, 0, {}}, 7001); }

TEST_F(Laz, HoldsWhatItsLasTwinHoldsInFewerBytes) {
  Crs codes;
  codes.epsg = 25832;
  for (const std::optional<Crs>& crs : {std::optional<Crs>(), std::optional(codes)}) {  // point formats 6 7, 0 2
    for (const bool colour : {false, true}) {
      const fs::path las = write_cloud("a.las", colour, crs), laz = write_cloud("a.laz", colour, crs);
      EXPECT_LT(fs::file_size(laz), fs::file_size(las) * 8 / 10);
      const auto plain = whole(las), compressed = whole(laz);
      ASSERT_TRUE(plain && compressed) << error_of(plain) << error_of(compressed);
      ASSERT_EQ(compressed->p_in_scan.size(), kPoints);
      EXPECT_EQ(compressed->p_in_scan, plain->p_in_scan);
      EXPECT_EQ(compressed->chunk.intensity, plain->chunk.intensity);
      EXPECT_EQ(compressed->chunk.colour, plain->chunk.colour);
      EXPECT_EQ(compressed->header.has_colour, colour);
      EXPECT_EQ(compressed->header.num_points, kPoints);
      EXPECT_EQ(compressed->header.format, "laz");
      expect_near(compressed->p_in_scan[100'000], points_on_a_map()[100'000].position, 1e-4);
      // The header but for the mark of compression and the place of the points.
      std::string a = bytes_of(las).substr(0, kHeaderBytes), b = bytes_of(laz).substr(0, kHeaderBytes);
      for (std::string* header : {&a, &b}) header->replace(96, 9, 9, '\0');
      EXPECT_EQ(a, b);
    }
  }
}

#ifdef ISTHMUS_HAS_LASZIP
TEST_F(Laz, EveryPointHasItsStationForOtherPrograms) {
  Crs codes;
  codes.epsg = 25832;
  for (const std::optional<Crs>& crs : {std::optional<Crs>(), std::optional(codes)}) {
    const LaszipHandle laszip;
    laszip_BOOL compressed = 0;
    laszip_point_struct* point = nullptr;
    ASSERT_EQ(laszip_open_reader(laszip.get(), write_cloud("a.laz", true, crs).c_str(), &compressed), 0);
    ASSERT_EQ(laszip_get_point_pointer(laszip.get(), &point), 0);
    EXPECT_EQ(compressed, 1);
    for (std::size_t i = 0; i < kPoints; ++i) {
      ASSERT_EQ(laszip_read_point(laszip.get()), 0) << i;
      ASSERT_EQ(point->point_source_ID, 1 + i / 1000);
      ASSERT_EQ(crs ? point->return_number : point->extended_return_number, 1);
      ASSERT_EQ(crs ? point->number_of_returns : point->extended_number_of_returns, 1);
      ASSERT_EQ(point->rgb[1], 257 * (i / 256 % 256));
    }
  }
}
#endif

TEST_F(Laz, IsKnownByItsContentWhateverItsName) {
  fs::rename(write_cloud("a.laz", false), folder / "b.las");
  const auto scan = whole(folder / "b.las");
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->p_in_scan.size(), kPoints);
}

TEST_F(Laz, SamePointsGiveTheSameBytes) {
  EXPECT_EQ(bytes_of(write_cloud("a.laz", true)), bytes_of(write_cloud("b.laz", true)));
}

TEST_F(Laz, AProbeLooksIntoEveryPartAndDisturbsNothing) {
  const fs::path path = write_cloud("a.laz", false);
  auto reader = open_probing({path, 0, {}});
  ASSERT_TRUE(reader) << error_of(reader);
  PointChunk first, probe;
  ASSERT_TRUE((*reader)->read(first, 10));
  const auto probed = (*reader)->probe(3000);
  ASSERT_TRUE(probed) << error_of(probed);
  EXPECT_EQ(probed->points.size(), 3000U);
  const double x0 = (*reader)->header().local_origin_in_scan.x() - 500'000;
  double before = -1, widest = 0;
  for (const Eigen::Vector3f& p : probed->points) {
    const double index = (p.x() + x0) * 1000;
    EXPECT_GT(index, before);
    widest = std::max(widest, index - before);
    before = index;
  }
  EXPECT_GT(before, kPoints * 0.9);
  EXPECT_LT(widest, kPoints * 0.1);
  ASSERT_TRUE((*reader)->read(first, 10));
  EXPECT_NEAR((first.points[0].x() + x0) * 1000, 10, 0.2);
}

TEST_F(Laz, BrokenFilesAreNamedWithThePlace) {
  const std::string good = bytes_of(write_cloud("good.laz", true));
  const auto error = [&](const std::string& bytes) { return error_of(whole(write("bad.laz", bytes))); };
  const auto changed = [&](std::size_t at, const auto& value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return error(bytes);
  };
  const auto expect = [](const std::string& text, const std::string& what, const std::string& where) {
    EXPECT_NE(text.find(what), std::string::npos) << text;
    EXPECT_NE(text.find("bad.laz" + where), std::string::npos) << text;
  };
  constexpr std::size_t kPayload = kHeaderBytes + 54, kPointsBegin = kPayload + 34 + 2 * 6;
  expect(error(good.substr(0, 400)), "54 bytes are missing", ", byte 375");
  expect(error(good.substr(0, kPointsBegin + 4)), "8 bytes are missing", ", byte 475");
  expect(error(good.substr(0, good.size() / 2)), "the table of chunks should be at byte", ", byte 475");
  expect(changed(kHeaderBytes + 2, 'x'), "the record of LASzip that says how is missing", ", byte 375");
  expect(changed(kPayload, std::uint16_t{9}), "LASzip's compressor 9", ", byte 429");
  expect(changed(kPayload + 34, std::uint16_t{6}), "does not describe points of format 7", ", byte 463");
  expect(changed(kPayload + 38, std::uint16_t{7}), "version 7 of compressed points", ", byte 467");
  expect(changed(100, 4'000'000'000U), "4000000000 variable length records", ", byte 100");
  expect(changed(kHeaderBytes + 20, std::uint16_t{60000}), "reaches into the points", ", byte 375");
  expect(changed(247, std::uint64_t{1'000'000}), "the header says 1000000 points, the file holds 3 chunks of 50000",
         "");
  expect(changed(247, std::uint64_t{0}), "holds no points", "");
  expect(changed(kPointsBegin, std::uint64_t{kPointsBegin}), "never written", ", byte 475");
  std::uint64_t table = 0;
  std::memcpy(&table, good.data() + kPointsBegin, sizeof table);
  expect(changed(table + 4, 4'000'000'000U), "4000000000 chunks", fmt::format(", byte {}", table));
}

// There are no checksums. In chunks of the old coding a wrong bit moves the end; in those of the new one, whose layers
// have lengths of their own, it may move points.
TEST_F(Laz, DamageInsideAChunkIsFoundWhereThePointsTellIt) {
  Crs codes;
  codes.epsg = 25832;
  for (const std::optional<Crs>& crs : {std::optional<Crs>(), std::optional(codes)}) {
    std::string bytes = bytes_of(write_cloud("good.laz", true, crs));
    EXPECT_EQ(whole(folder / "good.laz")->header.notes.size(), 1U);
    bytes.replace(bytes.size() / 3, 5000, 5000, '\0');
    const auto scan = whole(write("bad.laz", bytes));
    if (crs) {
      EXPECT_NE(error_of(scan).find("the compressed points are damaged or missing from point "), std::string::npos)
          << error_of(scan);
    } else {
      ASSERT_TRUE(scan) << error_of(scan);
      EXPECT_NE(scan->header.notes.back().find("points lie outside the bounds in the header"), std::string::npos);
    }
  }
}

TEST(NoLaz, SaysHowToHaveIt) {
  if (has_laz()) GTEST_SKIP() << "this build has LASzip";
  EXPECT_TRUE(is_known_but_unsupported("a.laz"));
  const auto writer = CloudWriter::create(fs::temp_directory_path() / "isthmus_no.laz", {});
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().text().find("ISTHMUS_LAZ"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::io::testing
