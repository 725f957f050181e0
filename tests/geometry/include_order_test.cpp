// The house rules of src/, read from the sources: includes point only down the list of modules, the library knows neither
// pipelines nor tools, and PCL stays behind the sources that may use it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::array kModules{"base",    "config",    "geometry", "scan",   "io",    "features",
                              "regions", "congruent", "pairwise", "survey", "store", "report"};

struct Include {
  fs::path file;  ///< relative to the source folder
  std::size_t line = 0;
  std::string header;
};

std::string place(const Include& i) { return i.file.string() + ":" + std::to_string(i.line) + " includes " + i.header; }

std::vector<Include> includes_below(const std::string& folder) {
  static const std::regex pattern("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
  const fs::path root(ISTHMUS_SOURCE_DIR);
  std::vector<Include> out;
  if (!fs::exists(root / folder)) return out;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream in(entry.path());
    std::string line;
    for (std::size_t n = 1; std::getline(in, line); ++n) {
      std::smatch match;
      if (std::regex_match(line, match, pattern)) out.push_back({fs::relative(entry.path(), root), n, match[1]});
    }
  }
  return out;
}

std::string first_part(const std::string& path) { return path.substr(0, path.find('/')); }

int rank_of(const std::string& module) {
  const auto found = std::find(kModules.begin(), kModules.end(), module);
  return found == kModules.end() ? -1 : static_cast<int>(found - kModules.begin());
}

bool is_pcl(const std::string& header) { return header.rfind("pcl/", 0) == 0; }

TEST(IncludeOrder, EveryFolderOfSrcIsAModuleOfTheList) {
  for (const auto& entry : fs::directory_iterator(fs::path(ISTHMUS_SOURCE_DIR) / "src"))
    EXPECT_TRUE(!entry.is_directory() || rank_of(entry.path().filename()) >= 0)
        << entry.path() << " is not in the list of modules";
}

TEST(IncludeOrder, IncludesPointOnlyDownTheListOfModules) {
  const auto all = includes_below("src");
  ASSERT_GT(all.size(), 500u);
  std::size_t between_modules = 0;
  for (const Include& i : all) {
    const std::string module = (++i.file.begin())->string();
    const int to = rank_of(first_part(i.header));
    if (to < 0 || i.header.find('/') == std::string::npos) continue;
    ++between_modules;
    EXPECT_LE(to, rank_of(module)) << place(i) << ", which lies above it";
  }
  EXPECT_GT(between_modules, 100u);
}

TEST(IncludeOrder, TheLibraryKnowsNeitherPipelinesNorToolsNorTests) {
  for (const Include& i : includes_below("src")) {
    const std::string part = first_part(i.header);
    EXPECT_TRUE(part != "pipelines" && part != "tools" && part != "tests") << place(i);
    EXPECT_EQ(i.header.find(".."), std::string::npos) << place(i) << ": headers are named from src/";
  }
}

TEST(IncludeOrder, PclStaysBehindTheSourcesThatMayUseIt) {
  const std::set<std::string> allowed{"io", "features", "pairwise"};
  for (const char* folder : {"src", "pipelines", "tools"})
    for (const Include& i : includes_below(folder)) {
      if (!is_pcl(i.header)) continue;
      const std::string module = (++i.file.begin())->string();
      EXPECT_TRUE(std::string(folder) == "src" && i.file.extension() == ".cpp" && allowed.count(module)) << place(i);
    }
}

// A header that names no module is its neighbour's secret: quotes are for our own headers, written from src/.
TEST(IncludeOrder, ModuleHeadersExist) {
  const fs::path root(ISTHMUS_SOURCE_DIR);
  for (const Include& i : includes_below("src")) {
    if (rank_of(first_part(i.header)) < 0 || i.header.find('/') == std::string::npos) continue;
    EXPECT_TRUE(fs::exists(root / "src" / i.header)) << place(i) << ", which does not exist";
  }
}

}  // namespace
