// Promises that no compiler checks: on the tracked files of the source tree.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = ISTHMUS_SOURCE_DIR;

/// Paths relative to the source tree; empty outside a git clone.
std::vector<std::string> tracked_files() {
  const std::string command = fmt::format("git -C '{}' ls-files 2>/dev/null", kSource.string());
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  std::vector<std::string> files;
  std::array<char, 4096> line{};
  while (pipe && std::fgets(line.data(), line.size(), pipe.get())) {
    std::string file = line.data();
    file.pop_back();
    std::error_code error;
    if (fs::is_regular_file(kSource / file, error)) files.push_back(file);
  }
  return files;
}

std::vector<std::string> lines_of(const std::string& file) {
  std::vector<std::string> lines;
  const std::string text = read_file(kSource / file).value();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

class Repo : public ::testing::Test {
 protected:
  std::vector<std::string> files_ = tracked_files();
  void SetUp() override {
    if (files_.empty()) GTEST_SKIP() << "this is no git clone: the tracked files are not known";
  }
  /// Calls visit(file, line, "file:line") for every line of every tracked file with one of the extensions.
  template <class Visit>
  void for_each_line(const std::vector<std::string>& extensions, const Visit& visit) const {
    for (const std::string& file : files_) {
      const std::string extension = fs::path(file).extension().string();
      if (!extensions.empty() && std::ranges::find(extensions, extension) == extensions.end()) continue;
      int number = 0;
      for (const std::string& line : lines_of(file)) visit(file, line, fmt::format("{}:{}", file, ++number));
    }
  }
};

TEST_F(Repo, modules_include_only_modules_above_them_in_the_list) {
  std::map<std::string, std::size_t> place;
  const std::string list = read_file(kSource / "CMakeLists.txt").value();
  std::smatch modules;
  ASSERT_TRUE(std::regex_search(list, modules, std::regex(R"(set\(ISTHMUS_MODULES ([a-z ]+)\))")));
  const std::string names = modules[1];
  const std::regex word("[a-z]+");
  for (std::sregex_iterator i(names.begin(), names.end(), word), end; i != end; ++i)
    place.emplace(i->str(), place.size());
  place.emplace("pipelines", place.size());
  const std::regex include(R"re(^\s*#include "([a-z]+)/)re");
  for_each_line({".h", ".cpp"}, [&](const std::string& file, const std::string& line, const std::string& where) {
    std::smatch found;
    if (!file.starts_with("src/") || !std::regex_search(line, found, include)) return;
    const auto from = place.find(fs::path(file.substr(4)).begin()->string());
    ASSERT_NE(from, place.end()) << where;
    const auto to = place.find(found[1].str());
    if (to == place.end()) return;  // a folder within the module
    EXPECT_LE(to->second, from->second) << where << ": " << from->first << " may not know " << to->first;
  });
}

TEST_F(Repo, links_between_pages_lead_somewhere) {
  const std::regex link(R"re(\]\(([^)#\s]+)(#[^)]*)?\))re");
  for_each_line({".md"}, [&](const std::string& file, const std::string& line, const std::string& where) {
    for (std::sregex_iterator i(line.begin(), line.end(), link), end; i != end; ++i) {
      const std::string target = (*i)[1];
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(kSource / fs::path(file).parent_path() / target)) << where << " links to " << target;
    }
  });
}

TEST_F(Repo, every_page_is_reached_from_the_index) {
  const std::string index = read_file(kSource / "docs/index.md").value();
  for (const std::string& file : files_) {
    if (!file.starts_with("docs/") || !file.ends_with(".md") || file == "docs/index.md") continue;
    EXPECT_NE(index.find("](" + file.substr(5) + ")"), std::string::npos) << "docs/index.md does not link " << file;
  }
}

// Written in halves, so that this file does not hold what it forbids.
TEST_F(Repo, nothing_belongs_to_one_machine_or_to_how_it_was_written) {
  const std::regex machine(
      "/wor"
      "k/|/ro"
      "ot/|/ho"
      "me/[a-z]|/tm"
      "p/[a-z]");
  const std::regex hosts(
      "artifac"
      "tory|py"
      "pi\\.|registry\\.n"
      "pm|index-"
      "url|proxy\\.gol"
      "ang");
  const std::regex making(
      "\\b(sub-?)?ag"
      "ents?\\b|\\bllm\\b|\\bclau"
      "de\\b|\\bchat"
      "gpt\\b|\\bissues? #?[0-9]|\\b(by|in) a ses"
      "sion\\b",
      std::regex::icase);
  for_each_line({}, [&](const std::string& file, const std::string& line, const std::string& where) {
    if (file.ends_with(".png")) return;
    EXPECT_FALSE(std::regex_search(line, machine)) << where << ": a path of one machine: " << line;
    EXPECT_FALSE(std::regex_search(line, hosts)) << where << ": a package host: " << line;
    EXPECT_FALSE(std::regex_search(line, making)) << where << ": how it was made is not part of it: " << line;
  });
}

TEST_F(Repo, licence_is_the_whole_text_and_pictures_are_small) {
  const std::string licence = read_file(kSource / "LICENSE").value();
  EXPECT_EQ(licence.size(), 11358U) << "the text at apache.org/licenses/LICENSE-2.0.txt";
  EXPECT_NE(licence.find("END OF TERMS AND CONDITIONS"), std::string::npos);
  constexpr std::uintmax_t kMostBytes = 300'000;
  for (const std::string& file : files_) EXPECT_LE(fs::file_size(kSource / file), kMostBytes) << file;
}

}  // namespace
}  // namespace isthmus
