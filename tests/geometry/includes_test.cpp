// Rules for includes of src/ beside their order (tests/repo): the library knows neither pipelines nor tools, headers
// are named from src/ and exist, and PCL stays behind the sources that may use it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

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

bool is_module(const std::string& folder) { return fs::is_directory(fs::path(ISTHMUS_SOURCE_DIR) / "src" / folder); }

bool is_pcl(const std::string& header) { return header.rfind("pcl/", 0) == 0; }

TEST(Includes, TheLibraryKnowsNeitherPipelinesNorToolsNorTests) {
  const auto all = includes_below("src");
  ASSERT_GT(all.size(), 500u);
  for (const Include& i : all) {
    const std::string part = first_part(i.header);
    EXPECT_TRUE(part != "pipelines" && part != "tools" && part != "tests") << place(i);
    EXPECT_EQ(i.header.find(".."), std::string::npos) << place(i) << ": headers are named from src/";
  }
}

TEST(Includes, PclStaysBehindTheSourcesThatMayUseIt) {
  const std::set<std::string> allowed{"io", "features", "pairwise"};
  for (const char* folder : {"src", "pipelines", "tools"})
    for (const Include& i : includes_below(folder)) {
      if (!is_pcl(i.header)) continue;
      const std::string module = (++i.file.begin())->string();
      EXPECT_TRUE(std::string(folder) == "src" && i.file.extension() == ".cpp" && allowed.count(module)) << place(i);
    }
}

TEST(Includes, ModuleHeadersExist) {
  const fs::path root(ISTHMUS_SOURCE_DIR);
  for (const Include& i : includes_below("src")) {
    if (i.header.find('/') == std::string::npos || !is_module(first_part(i.header))) continue;
    EXPECT_TRUE(fs::exists(root / "src" / i.header)) << place(i) << ", which does not exist";
  }
}

}  // namespace
