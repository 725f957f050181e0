#include "io/scan_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "base/parallel.h"
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

void sort_by_name(std::vector<ListedScan>& scans) {
  std::sort(scans.begin(), scans.end(), [](const ListedScan& a, const ListedScan& b) {
    const auto file_a = std::string_view(a.scan.name).substr(0, a.scan.name.find('#'));
    const auto file_b = std::string_view(b.scan.name).substr(0, b.scan.name.find('#'));
    return std::tie(file_a, a.scan.index) < std::tie(file_b, b.scan.index);
  });
}

std::string name_in(const fs::path& base, const fs::path& path) { return scan_name(path.lexically_relative(base), {}); }

/// The scans of a file, or the file with its error.
std::vector<ListedScan> listed_scans(const fs::path& path, const fs::path& base) {
  auto scans = scans_of_file(path);
  if (!scans) return {{{path, 0, name_in(base, path)}, std::move(scans.error())}};
  std::vector<ListedScan> listed;
  for (ScanRef& scan : *scans) {
    const bool several = scans->size() > 1;
    scan.name = scan_name(path.lexically_relative(base), several ? std::optional(scan.index) : std::nullopt);
    listed.push_back({std::move(scan), {}});
  }
  return listed;
}

class Lister {
 public:
  Lister(fs::path base, const std::vector<fs::path>& skip_folders) {
    listing_.base = std::move(base);
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
  [[nodiscard]] std::string name_of(const fs::path& path) const { return name_in(listing_.base, path); }
  void add_error(const fs::path& path, Error error) {
    listing_.scans.push_back({{path, 0, name_of(path)}, std::move(error)});
  }
  void consider(const fs::path& path);
  void take_by_stem();

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
      listing_.warnings.push_back(name_of(path) + ": a link to a folder, not entered");
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
  for (ListedScan& scan : listed_scans(path, listing_.base)) listing_.scans.push_back(std::move(scan));
}

void Lister::take_by_stem() {
  for (auto& [stem, files] : by_stem_) {
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
      return std::pair(preference_of(a), a) < std::pair(preference_of(b), b);
    });
    for (std::size_t i = 1; i < files.size(); ++i) {
      listing_.warnings.push_back(
          fmt::format("{}: not used, {} is taken for the same scan", name_of(files[i]), name_of(files[0])));
    }
    add_file(files[0]);
    if (files.size() > 1) listing_.twins.push_back({files[0], {files.begin() + 1, files.end()}});
  }
}

ScanListing Lister::finish() {
  take_by_stem();
  for (const auto& [extension, count] : other_extensions_) {
    listing_.notes.push_back(fmt::format("{} files with extension '{}' are no scans", count, extension));
  }
  std::sort(listing_.notes.begin(), listing_.notes.end());
  std::sort(listing_.warnings.begin(), listing_.warnings.end());
  sort_by_name(listing_.scans);
  return std::move(listing_);
}

/// What is wrong with a file's scans; nothing if at least one can be read.
std::optional<Error> trouble_of_file(const std::vector<ListedScan>& scans,
                                     const std::function<std::optional<Error>(const ScanRef&)>& trouble_of) {
  std::optional<Error> first;
  for (const ListedScan& listed : scans) {
    std::optional<Error> trouble = listed.error ? listed.error : trouble_of(listed.scan);
    if (!trouble) return std::nullopt;
    if (!first) first = std::move(trouble);
  }
  return first;
}

/// The scans of the first readable twin, and what was wrong with the taken file.
struct Replacement {
  std::vector<ListedScan> scans;  ///< empty: the taken file stays
  fs::path file;
  Error trouble;
};

Replacement replacement_of(const TwinFiles& twins, const fs::path& base,
                           const std::function<std::optional<Error>(const ScanRef&)>& trouble_of) {
  std::optional<Error> trouble = trouble_of_file(listed_scans(twins.taken, base), trouble_of);
  if (!trouble) return {};
  for (const fs::path& other : twins.others) {
    std::vector<ListedScan> scans = listed_scans(other, base);
    if (!trouble_of_file(scans, trouble_of)) return {std::move(scans), other, std::move(*trouble)};
  }
  return {};
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

void take_readable_twins(ScanListing& listing, const std::function<std::optional<Error>(const ScanRef&)>& trouble_of) {
  std::vector<Replacement> found(listing.twins.size());
  parallel_for_index(found.size(), 1,
                     [&](std::size_t i) { found[i] = replacement_of(listing.twins[i], listing.base, trouble_of); });
  for (std::size_t i = 0; i < found.size(); ++i) {
    TwinFiles& twins = listing.twins[i];
    if (found[i].scans.empty()) continue;
    const std::string bad = name_in(listing.base, twins.taken), good = name_in(listing.base, found[i].file);
    std::erase(listing.warnings, fmt::format("{}: not used, {} is taken for the same scan", good, bad));
    listing.warnings.push_back(
        fmt::format("{}: cannot be used ({}), {} is taken for the same scan", bad, found[i].trouble.what, good));
    std::erase_if(listing.scans, [&](const ListedScan& s) { return s.scan.path == twins.taken; });
    const bool listed = std::ranges::any_of(
        listing.scans, [&](const ListedScan& s) { return s.scan.path == found[i].file; });  // named by the user as well
    if (!listed) listing.scans.insert(listing.scans.end(), found[i].scans.begin(), found[i].scans.end());
    std::erase(twins.others, found[i].file);
    twins.others.insert(twins.others.begin(), std::exchange(twins.taken, found[i].file));
  }
  std::sort(listing.warnings.begin(), listing.warnings.end());
  sort_by_name(listing.scans);
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
