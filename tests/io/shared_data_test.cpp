#include "shared_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>

#include "io/format_table.h"
#include "io_testing.h"

namespace isthmus::io::testing {
namespace {

namespace fs = std::filesystem;

/// All scans of a file, or the first error.
Result<std::uint64_t> count_points(const fs::path& path) {
  auto scans = scans_of_file(path);
  if (!scans) return tl::unexpected(scans.error());
  std::uint64_t points = 0;
  for (const ScanRef& ref : *scans) {
    auto scan = read_whole(ref, 10000);
    if (!scan) return tl::unexpected(scan.error());
    points += scan->p_in_scan.size();
  }
  return points;
}

std::map<std::string, std::string> expected_counts(const fs::path& csv) {
  std::map<std::string, std::string> counts;
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const auto comma = line.rfind(',');
    counts[line.substr(0, comma)] = line.substr(comma + 1);
  }
  return counts;
}

TEST(SharedFormats, EveryFileGivesItsCountOrOneClearError) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  const fs::path folder = data / "formats";
  const auto expected = expected_counts(folder / "expected.csv");
  ASSERT_GT(expected.size(), 60U);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::map<std::string, std::string> missing = expected;
  for (const fs::path& path : files) {
    const std::string name = path.lexically_relative(folder).generic_string();
    missing.erase(name);
    const auto count = count_points(path);
    const std::string outcome = count ? std::to_string(*count) + " points" : count.error().text();
    std::cout << name << ": " << outcome << "\n";
    if (!count) {
      EXPECT_FALSE(count.error().what.empty());
      EXPECT_NE(count.error().where.find(path.filename().string()), std::string::npos) << outcome;
    }
    if (is_known_but_unsupported(path)) {
      EXPECT_NE(outcome.find("unsupported format"), std::string::npos) << name << ": " << outcome;
      continue;
    }
    const auto row = expected.find(name);
    if (row == expected.end()) continue;
    if (row->second.empty()) {
      EXPECT_FALSE(count && *count > 0) << name << ": " << outcome;
    } else {
      EXPECT_EQ(outcome, row->second + " points") << name;
    }
  }
  for (const auto& [name, count] : missing) ADD_FAILURE() << "there is no file " << name << ", which is expected.csv's";
}

TEST(SharedFormats, EverySetReads) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  int sets = 0;
  for (const auto& entry : fs::directory_iterator(data)) {
    if (!entry.is_directory() || entry.path().filename() == "formats") continue;
    ++sets;
    for (const auto& file : fs::directory_iterator(entry.path())) {
      const auto extension = file.path().extension();
      if (extension == ".txt" || extension == ".conf" || extension == ".pose") continue;
      const auto count = count_points(file.path());
      ASSERT_TRUE(count) << error_of(count);
      EXPECT_GT(*count, 1000U) << file.path();
      const auto probe = probe_scan({file.path(), 0, {}}, 1000);
      ASSERT_TRUE(probe) << error_of(probe);
      EXPECT_GT(probe->points.size(), 700U) << file.path();
      EXPECT_LE(probe->points.size(), 1000U) << file.path();
    }
  }
  EXPECT_GE(sets, 9);
}

// The .xyz files are the .3d files turned to x forward, y left, z up in metres with three decimals by other software.
TEST(SharedFormats, ThreeDtkScansAgreeWithTheirMetricTwins) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  for (const char* stem : {"scan000", "scan001", "scan002"}) {
    const auto left_handed = read_whole(data / "tls_3dtk_dat" / (std::string(stem) + ".3d"));
    const auto metric = read_whole(data / "tls_3dtk_dat" / (std::string(stem) + ".xyz"));
    ASSERT_TRUE(left_handed && metric);
    ASSERT_EQ(left_handed->p_in_scan.size(), metric->p_in_scan.size());
    double largest = 0;
    for (std::size_t i = 0; i < metric->p_in_scan.size(); ++i) {
      largest = std::max(largest, (left_handed->p_in_scan[i] - metric->p_in_scan[i]).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(largest, 0.00051);
  }
}

}  // namespace
}  // namespace isthmus::io::testing
