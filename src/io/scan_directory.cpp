#include "io/scan_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "io/format_table.h"
#include "io/scan_name.h"
#include "io/text/table_reader.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

namespace fs = std::filesystem;

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

// Files of the project's own kinds that end in .txt.
bool is_companion(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  return name.ends_with(".gt.txt") ||
         ((name.starts_with("poses") || name.starts_with("overlaps")) && name.ends_with(".txt"));
}

bool is_loose_text(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension == ".txt" || extension == ".csv" || extension == ".asc";
}

class Lister {
 public:
  Lister(fs::path base, const std::vector<fs::path>& skip_folders) : base_(std::move(base)) {
    for (const fs::path& folder : skip_folders) skip_.insert(normal(folder));
  }

  static fs::path normal(const fs::path& path) {
    std::error_code error;
    fs::path absolute = fs::absolute(path, error).lexically_normal();
    return absolute.has_filename() ? absolute : absolute.parent_path();
  }

  void add_folder(const fs::path& folder);
  void add_file(const fs::path& path);
  ScanListing finish();

 private:
  [[nodiscard]] std::string name_of(const fs::path& path) const {
    return scan_name(path.lexically_relative(base_), {});
  }
  void add_error(const fs::path& path, Error error) {
    listing_.scans.push_back({{path, 0, name_of(path)}, std::move(error)});
  }
  void consider(const fs::path& path);
  void take_by_stem();

  fs::path base_;
  std::set<fs::path> skip_;
  std::set<fs::path> taken_;
  std::map<fs::path, std::vector<fs::path>> by_stem_;    // folder and stem -> files with that stem
  std::map<std::string, std::size_t> other_extensions_;  // extension -> number of files
  ScanListing listing_;
};

void Lister::add_folder(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) return add_error(folder, Error{"folder cannot be listed: " + error.message(), folder.string(), {}});
  for (; entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& path = entries->path();
    std::error_code ignored;
    if (is_hidden(path) || skip_.contains(path)) continue;
    if (!entries->is_directory(ignored)) {
      consider(path);
    } else if (entries->is_symlink(ignored)) {
      listing_.notes.push_back(name_of(path) + ": a link to a folder, not entered");
    } else {
      add_folder(path);
    }
    if (error) break;
  }
  if (error) add_error(folder, Error{"folder cannot be listed: " + error.message(), folder.string(), {}});
}

void Lister::consider(const fs::path& path) {
  if (is_companion(path)) return;
  if (!format_of(path) && !is_known_but_unsupported(path)) {
    ++other_extensions_[lower_case(path.extension().string())];
  } else if (is_loose_text(path) && !may_hold_coordinates(path)) {
    listing_.notes.push_back(name_of(path) + ": no coordinates, not taken as a scan");
  } else {
    by_stem_[path.parent_path() / path.stem()].push_back(path);
  }
}

void Lister::add_file(const fs::path& path) {
  if (!taken_.insert(path).second) return;
  auto scans = scans_of_file(path);
  if (!scans) return add_error(path, std::move(scans.error()));
  for (ScanRef& scan : *scans) {
    const bool several = scans->size() > 1;
    scan.name = scan_name(path.lexically_relative(base_), several ? std::optional(scan.index) : std::nullopt);
    listing_.scans.push_back({std::move(scan), {}});
  }
}

void Lister::take_by_stem() {
  for (auto& [stem, files] : by_stem_) {
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
      return std::pair(preference_of(a), a) < std::pair(preference_of(b), b);
    });
    for (std::size_t i = 1; i < files.size(); ++i) {
      listing_.notes.push_back(
          fmt::format("{}: not used, {} is taken for the same scan", name_of(files[i]), name_of(files[0])));
    }
    add_file(files[0]);
  }
}

ScanListing Lister::finish() {
  take_by_stem();
  for (const auto& [extension, count] : other_extensions_) {
    listing_.notes.push_back(fmt::format("{} files with extension '{}' are no scans", count, extension));
  }
  std::sort(listing_.notes.begin(), listing_.notes.end());
  std::sort(listing_.scans.begin(), listing_.scans.end(), [](const ListedScan& a, const ListedScan& b) {
    const auto file_a = std::string_view(a.scan.name).substr(0, a.scan.name.find('#'));
    const auto file_b = std::string_view(b.scan.name).substr(0, b.scan.name.find('#'));
    return std::tie(file_a, a.scan.index) < std::tie(file_b, b.scan.index);
  });
  return std::move(listing_);
}

fs::path common_folder(const fs::path& a, const fs::path& b) {
  fs::path common;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end() && *i == *j; ++i, ++j) common /= *i;
  return common;
}

}  // namespace

Result<ScanListing> list_scans(const std::vector<fs::path>& inputs, const std::vector<fs::path>& skip_folders) {
  if (inputs.empty()) return fail("no scans given", {}, "name a folder or files");
  std::vector<fs::path> folders, files;
  std::optional<fs::path> base;
  bool any_exists = false;
  for (const fs::path& input : inputs) {
    const fs::path path = Lister::normal(input);
    std::error_code ignored;
    const bool is_folder = fs::is_directory(path, ignored);
    any_exists |= fs::exists(path, ignored);
    (is_folder ? folders : files).push_back(path);
    const fs::path folder = is_folder ? path : path.parent_path();
    base = base ? common_folder(*base, folder) : folder;
  }
  if (!any_exists) return fail("no such file or folder", inputs.front().string());
  Lister lister(*base, skip_folders);
  for (const fs::path& file : files) lister.add_file(file);
  for (const fs::path& folder : folders) lister.add_folder(folder);
  return lister.finish();
}

Result<ScanRef> resolve_scan_name(const std::string& text) {
  std::error_code ignored;
  fs::path path;
  std::optional<int> index;
  const std::size_t hash = text.rfind('#');
  const auto exists = [&](const std::string& candidate) {
    for (const std::string& spelling : {candidate, percent_decoded(candidate)}) {
      if (path.empty() && fs::exists(spelling, ignored)) path = spelling;
    }
    return !path.empty();
  };
  if (!exists(text) && hash != std::string::npos) {
    int k = 0;
    const char* const end = text.data() + text.size();
    const bool whole = std::from_chars(text.data() + hash + 1, end, k).ptr == end && hash + 1 < text.size();
    if (whole && k >= 0 && exists(text.substr(0, hash))) index = k;
  }
  if (path.empty()) return fail("no such file", text);
  if (fs::is_directory(path, ignored)) return fail("is a folder, a scan is wanted", text, "name a file in it");
  auto scans = scans_of_file(path);
  if (!scans) return tl::unexpected(std::move(scans.error()));
  const std::size_t n = scans->size();
  if (!index && n > 1) {
    return fail(fmt::format("holds {} scans", n), text, fmt::format("name one: {}#0 to {}#{}", text, text, n - 1));
  }
  if (static_cast<std::size_t>(index.value_or(0)) >= n) {
    return fail(fmt::format("the file holds {} scans, there is no #{}", n, *index), text, "scans are counted from 0");
  }
  return (*scans)[static_cast<std::size_t>(index.value_or(0))];
}

}  // namespace isthmus::io
