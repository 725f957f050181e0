#include <cmath>
#include <fstream>

#include "base/rng.h"
#include "e57_testing.h"
#include "io/e57/e57_pages.h"
#include "io/inspect.h"
#include "io/scan_directory.h"

namespace isthmus::io::testing {
namespace {

using Doubles = std::vector<double>;

class E57 : public IoTest {};

std::string xyz_packet(const Doubles& x, const Doubles& y, const Doubles& z) {
  return data_packet({raw_bytes(x), raw_bytes(y), raw_bytes(z)});
}

TEST(E57Checksum, AgreesWithTheBitwiseOneAndTheKnownValue) {
  EXPECT_EQ(crc32c("123456789"), 0xE3069283U);  // the check value of CRC-32C
  std::string bytes;
  Rng rng(3);
  for (int length = 0; length < 1100; ++length) {
    ASSERT_EQ(crc32c(bytes), slow_crc32c(bytes)) << length;
    bytes += static_cast<char>(rng.below(256));
  }
}

TEST_F(E57, ReadsIntegersOfAnyWidthInAnyOrderOfFields) {
  Rng rng(7);
  for (const unsigned bits : {1U, 2U, 3U, 7U, 8U, 9U, 13U, 16U, 17U, 31U, 32U, 33U, 56U, 57U, 58U, 63U, 64U}) {
    const std::int64_t minimum = static_cast<std::int64_t>(~std::uint64_t{0} << (bits - 1));
    const std::int64_t maximum = -(minimum + 1);
    const std::string limits =
        "minimum=\"" + std::to_string(minimum) + "\" maximum=\"" + std::to_string(maximum) + "\"";
    constexpr std::size_t kCount = 1000;
    std::array<std::vector<std::int64_t>, 2> values;
    std::array<std::vector<std::uint64_t>, 2> stored;
    Doubles x;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t f = 0; f < 2; ++f) {
        const auto value =
            std::clamp<std::int64_t>(static_cast<std::int64_t>(rng.below(2001)) - 1000, minimum, maximum);
        values[f].push_back(value);
        stored[f].push_back(static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(minimum));
      }
      x.push_back(static_cast<double>(i));
    }
    // z y x; z is cut between packets at a byte that is within a record for most widths
    const std::string z = packed(stored[0], bits), y = packed(stored[1], bits);
    const std::size_t cut = z.size() / 3;
    HandMadeE57 e57;
    e57.add_scan(kCount,
                 field_xml("cartesianZ", "type=\"Integer\" " + limits) +
                     field_xml("cartesianY", "type=\"ScaledInteger\" scale=\"0.5\" offset=\"-3\" " + limits) +
                     field_xml("cartesianX", "type=\"Float\" precision=\"double\""),
                 data_packet({z.substr(0, cut), y, {}}) + data_packet({z.substr(cut), {}, raw_bytes(x)}));
    const auto scan = read_whole(ScanRef{write("a.e57", e57.file()), 0, {}}, 333);
    ASSERT_TRUE(scan) << error_of(scan);
    ASSERT_EQ(scan->p_in_scan.size(), kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Eigen::Vector3d expected(x[i], static_cast<double>(values[1][i]) * 0.5 - 3,
                                     static_cast<double>(values[0][i]));
      ASSERT_EQ(scan->p_in_scan[i], expected) << bits << " bits, record " << i;
    }
  }
}

TEST_F(E57, IntegersWithoutLimitsAre64BitsAndEmptyNumbersAreZero) {
  HandMadeE57 e57;
  e57.add_scan(2,
               field_xml("cartesianX", R"(type="Integer")") + doubles_xml({"cartesianY"}) +
                   field_xml("cartesianZ", R"(type="Float" precision="single")"),
               data_packet({packed({std::uint64_t{1} << 63 | 5, (std::uint64_t{1} << 63) - 6}, 64),
                            raw_bytes<double>({1, 2}), raw_bytes<float>({0.25F, 0.5F})}),
               R"(<pose type="Structure"><rotation type="Structure"><w type="Float">1</w><x type="Float"/>
                  <y type="Float"/><z type="Float"/></rotation></pose>)");
  const auto scan = read_whole(write("a.e57", e57.file()));
  ASSERT_TRUE(scan) << error_of(scan);
  EXPECT_EQ(scan->p_in_scan[0], Eigen::Vector3d(5, 1, 0.25));
  EXPECT_EQ(scan->p_in_scan[1], Eigen::Vector3d(-6, 2, 0.5));
  EXPECT_TRUE(scan->header.file_from_scan->isApprox(Transform::Identity()));
  EXPECT_EQ(scan->header.station_in_scan, Eigen::Vector3d::Zero());
}

TEST_F(E57, MapCoordinatesAreShiftedInDoubleAndHaveNoStation) {
  const std::string axis = R"(type="ScaledInteger" minimum="-2147483648" maximum="2147483647" scale="0.001" offset=")";
  const auto stored = [](double value, double offset) {
    return static_cast<std::uint64_t>(std::llround((value - offset) * 1000) + 2147483648LL);
  };
  HandMadeE57 e57;
  e57.add_scan(2,
               field_xml("cartesianX", axis + "500000\"") + field_xml("cartesianY", axis + "5240000\"") +
                   field_xml("cartesianZ", axis + "0\""),
               data_packet({packed({stored(500012.345, 5e5), stored(500012.346, 5e5)}, 32),
                            packed({stored(5240007.001, 524e4), stored(5240007.002, 524e4)}, 32),
                            packed({stored(-1.5, 0), stored(1.5, 0)}, 32)}));
  const auto scan = read_whole(write("a.e57", e57.file()));
  ASSERT_TRUE(scan) << error_of(scan);
  expect_near(scan->p_in_scan[0], {500012.345, 5240007.001, -1.5}, 1e-5);
  expect_near(scan->p_in_scan[1], {500012.346, 5240007.002, 1.5}, 1e-5);
  EXPECT_FALSE(scan->header.station_in_scan.has_value());
}

TEST_F(E57, ReadsSphericalCoordinatesWithElevationFromTheHorizontal) {
  HandMadeE57 e57;
  e57.add_scan(4,
               doubles_xml({"sphericalAzimuth", "sphericalElevation", "sphericalRange"}) +
                   field_xml("sphericalInvalidState", R"(type="Integer" minimum="0" maximum="2")"),
               data_packet({raw_bytes<double>({0, M_PI / 2, 0.3, 0}), raw_bytes<double>({0, 0, M_PI / 2, -M_PI / 6}),
                            raw_bytes<double>({2, 3, 5, 4}), packed({0, 0, 0, 0}, 2)}));
  const auto scan = read_whole(write("a.e57", e57.file()));
  ASSERT_TRUE(scan) << error_of(scan);
  expect_near(scan->p_in_scan[0], {2, 0, 0}, 1e-6);
  expect_near(scan->p_in_scan[1], {0, 3, 0}, 1e-6);
  expect_near(scan->p_in_scan[2], {0, 0, 5}, 1e-6);
  expect_near(scan->p_in_scan[3], {4 * std::cos(M_PI / 6), 0, -2}, 1e-6);
}

TEST_F(E57, PointsWithAnInvalidStateAreLeftOutAndCounted) {
  HandMadeE57 e57;
  const std::string state = field_xml("cartesianInvalidState", R"(type="Integer" minimum="0" maximum="2")");
  e57.add_scan(5, doubles_xml(kXyz) + state,
               data_packet({raw_bytes<double>({1, 2, 3, 4, 5}), raw_bytes<double>({0, 0, 0, 0, 0}),
                            raw_bytes<double>({0, 0, 0, 0, 0}), packed({1, 0, 2, 0, 1}, 2)}));
  e57.add_scan(2, doubles_xml(kXyz) + state,
               data_packet({raw_bytes<double>({1, 2}), raw_bytes<double>({0, 0}), raw_bytes<double>({0, 0}),
                            packed({1, 2}, 2)}));
  const auto path = write("a.e57", e57.file());
  const auto scan = read_whole(path);
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 2U);
  EXPECT_EQ(scan->p_in_scan[0].x(), 2.0);
  EXPECT_EQ(scan->p_in_scan[1].x(), 4.0);
  EXPECT_EQ(scan->header.num_points, 5U);
  EXPECT_NE(scan->header.notes.back().find("3 points without valid coordinates"), std::string::npos);
  EXPECT_NE(error_of(read_whole(ScanRef{path, 1, {}})).find("no valid points: all 2 are marked invalid"),
            std::string::npos);
}

TEST_F(E57, FieldsOfOneValueTakeNoSpaceAndOtherFieldsArePassedOver) {
  HandMadeE57 e57;
  e57.add_scan(3,
               field_xml("nor:normalX", R"(type="Float" precision="single")") +
                   field_xml("cartesianX", R"(type="Integer" minimum="0" maximum="7")") +
                   field_xml("remark", R"(type="String")") +
                   field_xml("cartesianY", R"(type="ScaledInteger" minimum="7" maximum="7" scale="0.5")") +
                   field_xml("cartesianZ", R"(type="Float" precision="single")") + doubles_xml({"timeStamp"}),
               data_packet({raw_bytes<float>({9, 9, 9}),
                            packed({1, 4, 7}, 3),
                            "three strings",
                            {},
                            raw_bytes<float>({1, 2, 3}),
                            raw_bytes<double>({9, 9, 9})}));
  const auto scan = read_whole(write("a.e57", e57.file()));
  ASSERT_TRUE(scan) << error_of(scan);
  ASSERT_EQ(scan->p_in_scan.size(), 3U);
  EXPECT_EQ(scan->p_in_scan[1], Eigen::Vector3d(4, 3.5, 2));
  HandMadeE57 endless;
  std::string nothing;
  for (const std::string& axis : kXyz) nothing += field_xml(axis, R"(type="Integer" minimum="1" maximum="1")");
  endless.add_scan(std::uint64_t{1} << 60, nothing, {});
  EXPECT_NE(error_of(read_whole(write("b.e57", endless.file()))).find("the XML says 1152921504606846976 points"),
            std::string::npos);
}

TEST_F(E57, IntensityStaysAsStoredAndColourIsScaledByItsLimits) {
  const auto colours = [](const std::string& attributes) {
    return field_xml("colorRed", attributes) + field_xml("colorGreen", attributes) + field_xml("colorBlue", attributes);
  };
  const auto scan_with = [&](const std::string& colour_xml, const std::string& values, const std::string& limits) {
    HandMadeE57 e57;
    e57.add_scan(2,
                 doubles_xml(kXyz) + field_xml("intensity", R"(type="Integer" minimum="-100" maximum="155")") +
                     field_xml("isIntensityInvalid", R"(type="Integer" minimum="0" maximum="1")") + colour_xml,
                 data_packet({raw_bytes<double>({1, 2}), raw_bytes<double>({0, 0}), raw_bytes<double>({0, 0}),
                              packed({90, 4}, 8), packed({0, 1}, 1), values, values, values}),
                 limits);
    return read_whole(write("a.e57", e57.file()));
  };
  const std::string declared =
      R"(<intensityLimits type="Structure"><intensityMinimum type="Integer">-100</intensityMinimum>
         <intensityMaximum type="Integer">155</intensityMaximum></intensityLimits><colorLimits type="Structure">
         <colorRedMinimum type="Integer">100</colorRedMinimum><colorRedMaximum type="Integer">300</colorRedMaximum>
         <colorGreenMinimum type="Integer"/><colorGreenMaximum type="Integer">1020</colorGreenMaximum>
         <colorBlueMinimum type="Integer"/><colorBlueMaximum type="Integer">65535</colorBlueMaximum></colorLimits>)";
  const auto by_limits =
      scan_with(colours(R"(type="Integer" minimum="0" maximum="65535")"), packed({200, 300}, 16), declared);
  ASSERT_TRUE(by_limits) << error_of(by_limits);
  EXPECT_EQ(by_limits->chunk.intensity[0], -10.0F);
  EXPECT_TRUE(std::isnan(by_limits->chunk.intensity[1]));
  EXPECT_NE(by_limits->header.notes[0].find("intensity limits -100 to 155"), std::string::npos);
  EXPECT_EQ(by_limits->chunk.colour[0], (std::array<std::uint8_t, 3>{128, 50, 1}));
  EXPECT_EQ(by_limits->chunk.colour[1], (std::array<std::uint8_t, 3>{255, 75, 1}));
  const auto by_bounds =
      scan_with(colours(R"(type="Integer" minimum="0" maximum="1023")"), packed({1023, 512}, 10), {});
  EXPECT_EQ(by_bounds->chunk.colour[0][0], 255);
  EXPECT_EQ(by_bounds->chunk.colour[1][0], 128);
  const auto bytes_in_words =
      scan_with(colours(R"(type="Integer" minimum="0" maximum="65535")"), packed({255, 20}, 16), {});
  EXPECT_EQ(bytes_in_words->chunk.colour[0][1], 255);
  const auto words = scan_with(colours(R"(type="Integer" minimum="0" maximum="65535")"), packed({65535, 20}, 16), {});
  EXPECT_EQ(words->chunk.colour[0][1], 255);
  const auto shares = scan_with(colours(R"(type="Float" precision="single")"), raw_bytes<float>({1.0F, 0.5F}), {});
  EXPECT_EQ(shares->chunk.colour[0][1], 255);
  EXPECT_EQ(shares->chunk.colour[1][1], 128);
}

TEST_F(E57, SeveralScansWithPosesAnEmptyOneAndABrokenOne) {
  HandMadeE57 e57;
  const double half = std::sqrt(0.5);
  e57.add_scan(1, doubles_xml(kXyz), xyz_packet({1}, {2}, {3}),
               "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" + std::to_string(half) +
                   "</w><x type=\"Float\"/><y type=\"Float\"/><z type=\"Float\">" + std::to_string(half) +
                   "</z></rotation><translation type=\"Structure\"><x type=\"Float\">10</x><y type=\"Float\">20</y><z "
                   "type=\"Float\">30</z></translation></pose>");
  e57.add_scan(0, doubles_xml(kXyz), {});
  e57.add_xml(0, 0, doubles_xml(kXyz));
  e57.add_scan(1, field_xml("cartesianX", R"(type="Integer" minimum="3" maximum="2")"), xyz_packet({1}, {2}, {3}));
  e57.add_scan(1, doubles_xml({"cartesianX", "cartesianY"}),
               data_packet({raw_bytes<double>({1}), raw_bytes<double>({1})}));
  e57.add_scan(2, doubles_xml(kXyz), xyz_packet({4, 5}, {5, 6}, {6, 7}),
               R"(<pose type="Structure"><rotation type="Structure"><w type="Float">2</w><x type="Float"/>
                  <y type="Float"/><z type="Float"/></rotation></pose>)");
  const auto path = write("zwei Räume 测试.e57", e57.file());
  const auto scans = scans_of_file(path);
  ASSERT_TRUE(scans) << error_of(scans);
  ASSERT_EQ(scans->size(), 6U);
  EXPECT_EQ((*scans)[5].name, "zwei%20Räume%20测试.e57#5");
  EXPECT_EQ(resolve_scan_name(path.string() + "#5")->index, 5);
  const auto first = read_whole((*scans)[0]);
  ASSERT_TRUE(first) << error_of(first);
  ASSERT_TRUE(first->header.file_from_scan.has_value());
  expect_near(*first->header.file_from_scan * Eigen::Vector3d(1, 2, 3), {10 - 2, 20 + 1, 33}, 1e-5);
  EXPECT_EQ(first->p_in_scan[0], Eigen::Vector3d(1, 2, 3));
  for (const std::size_t empty : {1U, 2U}) {
    EXPECT_NE(error_of(read_whole((*scans)[empty])).find("the scan holds no points"), std::string::npos);
  }
  EXPECT_NE(error_of(read_whole((*scans)[3])).find("scan #3 in its XML: the minimum 3 of 'cartesianX' is above"),
            std::string::npos);
  EXPECT_NE(error_of(read_whole((*scans)[4])).find("neither cartesianX"), std::string::npos);
  const auto last = read_whole((*scans)[5]);
  ASSERT_TRUE(last) << error_of(last);
  EXPECT_EQ(last->p_in_scan[1], Eigen::Vector3d(5, 6, 7));
  EXPECT_FALSE(last->header.file_from_scan.has_value());
  EXPECT_NE(last->header.notes.back().find("no unit quaternion"), std::string::npos);
  EXPECT_NE(error_of(read_whole(ScanRef{path, 6, {}})).find("there is no #6"), std::string::npos);
}

// Also packets that hold one field alone, so that each field meets its records at another place of the file.
TEST_F(E57, PacketsOfAllKindsInAnyDivision) {
  Rng rng(11);
  Doubles x, y, z;
  for (int i = 0; i < 5000; ++i) {
    x.push_back(i);
    y.push_back(rng.uniform());
    z.push_back(-i);
  }
  for (int trial = 0; trial < 30; ++trial) {
    const std::array<std::string, 3> streams = {raw_bytes(x), raw_bytes(y), raw_bytes(z)};
    std::array<std::size_t, 3> done = {};
    std::string packets;
    while (done[0] + done[1] + done[2] < 3 * streams[0].size()) {
      if (rng.below(4) == 0) packets += other_packet(rng.below(2) == 0 ? '\0' : '\2', 4 + 4 * rng.below(300));
      std::vector<std::string> pieces;
      for (std::size_t f = 0; f < 3; ++f) {
        const bool alone = trial % 2 == 0 && rng.below(3) != 0;
        const std::size_t length = alone ? 0 : std::min<std::size_t>(rng.below(20000), streams[f].size() - done[f]);
        pieces.push_back(streams[f].substr(done[f], length));
        done[f] += length;
      }
      packets += data_packet(pieces);
    }
    HandMadeE57 e57;
    e57.logical.resize(48 + 4 * rng.below(600));  // so that sections begin anywhere in a page
    e57.add_scan(x.size(), doubles_xml(kXyz), packets);
    const auto path = write("a.e57", e57.file());
    const auto scan = read_whole(ScanRef{path, 0, {}}, 700);
    ASSERT_TRUE(scan) << error_of(scan);
    ASSERT_EQ(scan->p_in_scan.size(), x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_EQ(scan->p_in_scan[i], Eigen::Vector3d(x[i], static_cast<double>(static_cast<float>(y[i])), z[i]));
    }
    const auto probe = probe_scan({path, 0, {}}, 1000);
    ASSERT_TRUE(probe) << error_of(probe);
    ASSERT_EQ(probe->points.size(), 1000U);
    for (std::size_t k = 0; k < 1000; ++k) {
      const Eigen::Vector3f p = probe->points[k];
      ASSERT_EQ(p.x(), -p.z());  // the fields are at the same record
      ASSERT_NEAR(p.x(), static_cast<double>(k) * 5, 25.0);
    }
  }
}

TEST_F(E57, RecordsAndHeadersMayLieOverPageBorders) {
  for (std::size_t pad = 0; pad < 1024; pad += 4) {
    HandMadeE57 e57;
    e57.logical.resize(48 + pad);
    e57.add_scan(3, doubles_xml(kXyz), xyz_packet({1, 2, 3}, {4, 5, 6}, {7, 8, 9}));
    const auto scan = read_whole(write("a.e57", e57.file()));
    ASSERT_TRUE(scan) << pad << ": " << error_of(scan);
    ASSERT_EQ(scan->p_in_scan[2], Eigen::Vector3d(3, 6, 9)) << pad;
  }
}

TEST_F(E57, DamagedPagesAreNamedAndOnlyThoseThatAreRead) {
  const Doubles many(1000, 1.5);
  HandMadeE57 e57;
  e57.add_scan(many.size(), doubles_xml(kXyz), xyz_packet(many, many, many));
  e57.add_scan(1, doubles_xml(kXyz), xyz_packet({1}, {2}, {3}));
  const std::string good = e57.file();
  const std::size_t pages = good.size() / 1024;
  ASSERT_GT(pages, 20U);
  for (std::size_t page = 0; page < pages; ++page) {
    std::string bad = good;
    bad[page * 1024 + (17 * page + 100) % 1024] ^= 4;
    const auto scan = read_whole(ScanRef{write("a.e57", bad), 0, {}}, 100);
    EXPECT_NE(error_of(scan).find("a.e57, byte " + std::to_string(page * 1024) + ": page " + std::to_string(page) +
                                  " is damaged: its checksum is"),
              std::string::npos)
        << page << ": " << error_of(scan);
  }
  std::string bad = good;
  bad[5 * 1024 + 1023] ^= 1;  // in the checksum itself
  const auto path = write("a.e57", bad);
  EXPECT_NE(error_of(read_whole(ScanRef{path, 0, {}})).find("page 5 is damaged"), std::string::npos);
  EXPECT_TRUE(read_whole(ScanRef{path, 1, {}}));
}

TEST_F(E57, WhatIsNoWholeE57IsRefusedWithItsPlace) {
  HandMadeE57 e57;
  const Doubles many(500, 1.5);
  e57.add_scan(many.size(), doubles_xml(kXyz), xyz_packet(many, many, many));
  const std::string good = e57.file();
  const auto refusal = [&](const std::string& bytes) { return error_of(scans_of_file(write("a.e57", bytes))); };
  const auto changed = [&](std::size_t at, auto value) {
    std::string logical = unpaged(good);
    logical.replace(at, sizeof value, bytes_of_value(value));
    return paged(logical);
  };
  EXPECT_NE(refusal("ASTM-E58" + good.substr(8)).find("byte 0: no E57 file: it starts with 'ASTM-E58'"),
            std::string::npos);
  EXPECT_NE(refusal("ply").find("no E57 file"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, 700)).find("the file ends inside its first page"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, 5000))
                .find("the header says " + std::to_string(good.size()) + " bytes, the file holds 5000"),
            std::string::npos);
  EXPECT_EQ(refusal(good + "something behind it"), "no error");
  EXPECT_NE(refusal(changed(8, std::uint32_t{2})).find("E57 version 2.0"), std::string::npos);
  EXPECT_NE(refusal(changed(40, std::uint64_t{4096})).find("pages of 4096 bytes"), std::string::npos);
  EXPECT_NE(refusal(changed(16, std::uint64_t{1000})).find("not a whole number of pages"), std::string::npos);
  EXPECT_NE(refusal(changed(24, std::uint64_t{1022})).find("an XML section of"), std::string::npos);
  EXPECT_NE(refusal(changed(32, ~std::uint64_t{0})).find("an XML section of"), std::string::npos);
  EXPECT_NE(refusal(changed(32, std::uint64_t{200})).find("the XML section cannot be read"), std::string::npos);
  const auto read_of = [&](const std::string& bytes) { return error_of(read_whole(write("a.e57", bytes))); };
  EXPECT_NE(read_of(changed(48, std::uint8_t{7})).find("byte 48: no section of points begins here: id 7"),
            std::string::npos);
  EXPECT_NE(read_of(changed(56, std::uint64_t{1} << 40)).find("a section of points cannot have"), std::string::npos);
  EXPECT_NE(read_of(changed(64, std::uint64_t{50})).find("cannot begin at byte 50"), std::string::npos);
  EXPECT_NE(read_of(changed(80, std::uint8_t{9})).find("byte 80: no packet of points begins here: type 9"),
            std::string::npos);
  EXPECT_NE(read_of(changed(82, std::uint16_t{0xFFFF})).find("a packet cannot have 65536 bytes here"),
            std::string::npos);
  EXPECT_NE(read_of(changed(84, std::uint16_t{4})).find("a data packet with 4 fields, the XML names 3"),
            std::string::npos);
  EXPECT_NE(read_of(changed(86, std::uint16_t{5000})).find("the fields of a data packet have"), std::string::npos);
  EXPECT_NE(read_of(changed(86, std::uint16_t{3992})).find("'cartesianX' has 499 records, the XML says more"),
            std::string::npos)
      << read_of(changed(86, std::uint16_t{3992}));
  HandMadeE57 too_many;
  too_many.add_scan(1000000, doubles_xml(kXyz), xyz_packet(many, many, many));
  EXPECT_NE(read_of(too_many.file()).find("the XML says 1000000 points, the file holds at most"), std::string::npos);
}

TEST_F(E57, ComesFirstWhereAScanLiesInSeveralFormats) {
  HandMadeE57 e57;
  e57.add_scan(1, doubles_xml(kXyz), xyz_packet({1}, {2}, {3}));
  write("a.e57", e57.file());
  write("a.ptx", "1\n");
  write("a.ply", "ply");
  const auto listing = list_scans({folder});
  ASSERT_TRUE(listing) << error_of(listing);
  ASSERT_EQ(listing->scans.size(), 1U);
  EXPECT_EQ(listing->scans[0].scan.name, "a.e57");
}

}  // namespace
}  // namespace isthmus::io::testing
