#include "pipelines/scan_names.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <functional>
#include <vector>

#include "config/nearest_word.h"
#include "io/scan_name.h"

namespace isthmus::pipelines {

Result<std::size_t> index_of_scan(std::span<const std::string> names, const std::string& wanted) {
  namespace fs = std::filesystem;
  const std::array<std::function<bool(const std::string&)>, 3> rules = {
      [&](const std::string& scan) { return scan == wanted || io::percent_decoded(scan) == wanted; },
      [&](const std::string& scan) { return fs::path(io::percent_decoded(scan)).filename() == wanted; },
      [&](const std::string& scan) { return fs::path(io::percent_decoded(scan)).stem() == wanted; }};
  for (const auto& rule : rules) {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (rule(names[k])) found.push_back(k);
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
      return fail(fmt::format("'{}' names {} scans", wanted, found.size()), {},
                  fmt::format("give the whole name as in scans.csv, such as {}", names[found.front()]));
    }
  }
  const std::string nearest = config::nearest_word(wanted, {names.begin(), names.end()});
  return fail(fmt::format("the survey has no scan '{}'", wanted), {},
              nearest.empty() ? "the names are in scans.csv" : "did you mean " + nearest + "?");
}

}  // namespace isthmus::pipelines
