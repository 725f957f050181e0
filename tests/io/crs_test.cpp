#include "io/crs.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace isthmus::io {
namespace {

TEST(Crs, CodesAreReadAndWrittenAsGeoTiffKeys) {
  const auto plain = parse_crs(" epsg:25832\n");
  ASSERT_TRUE(plain) << plain.error().text();
  EXPECT_EQ(plain->text, "EPSG:25832");
  EXPECT_FALSE(plain->is_wkt());
  const std::string bytes = geo_key_directory(*plain);
  std::array<std::uint16_t, 20> keys{};
  ASSERT_EQ(bytes.size(), sizeof keys);
  std::memcpy(keys.data(), bytes.data(), sizeof keys);
  EXPECT_EQ(keys, (std::array<std::uint16_t, 20>{1, 1, 0,    4, 1024, 0,     1,    1, 1025, 0,
                                                 1, 1, 3072, 0, 1,    25832, 3076, 0, 1,    9001}));
  const auto compound = parse_crs("EPSG:25832+7837");
  ASSERT_TRUE(compound);
  EXPECT_EQ(compound->text, "EPSG:25832+7837");
  EXPECT_EQ(geo_key_directory(*compound).size(), 8U * 7U);
}

TEST(Crs, WktIsTakenAsItIs) {
  const std::string wkt = "PROJCS[\"a ] name\",GEOGCS[\"g\",UNIT(\"degree\",0.017)],AUTHORITY[\"EPSG\",\"25832\"]]";
  const auto crs = parse_crs("\n" + wkt + "\n");
  ASSERT_TRUE(crs) << crs.error().text();
  EXPECT_TRUE(crs->is_wkt());
  EXPECT_EQ(crs->text, wkt);
  EXPECT_TRUE(parse_crs("ENGCRS[\"site grid\"]"));
}

TEST(Crs, AnythingElseIsRefusedWithWhatToGive) {
  for (const char* text : {"", "25832", "EPSG:", "EPSG:0", "EPSG:99999", "EPSG:25832+", "EPSG:25832+x", "UTM32[1]",
                           "PROJCS", "PROJCS[\"a\"", "PROJCS[\"a\")", "PROJCS[\"a\"] and more", "PROJCS[\"a]"}) {
    const auto crs = parse_crs(text);
    ASSERT_FALSE(crs) << text;
    EXPECT_NE(crs.error().hint.find("EPSG:25832"), std::string::npos) << text;
  }
  EXPECT_FALSE(parse_crs("PROJCS[\"" + std::string(70000, 'x') + "\"]"));
}

}  // namespace
}  // namespace isthmus::io
