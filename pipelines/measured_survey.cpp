#include "pipelines/measured_survey.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "base/digest.h"
#include "config/nearest_word.h"
#include "io/scan_name.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStage = "survey";
constexpr const char* kVersion = "1";  // of the form of MeasuredSurvey in the store

std::vector<int> ids_where(const MeasuredSurvey& survey, const std::function<bool(const std::string&)>& is) {
  std::vector<int> ids;
  for (const report::ScanRecord& scan : survey.scans) {
    if (is(scan.name)) ids.push_back(scan.id);
  }
  return ids;
}

}  // namespace

std::string keep_measured(const MeasuredSurvey& survey, const store::Store& store) {
  MeasuredSurvey content = survey;
  for (report::ScanRecord& scan : content.scans) scan.seconds.clear();  // what a run that finds all in the store lacks
  const std::array<std::string, 1> inputs = {store::to_bytes(content)};
  const store::Key key = store::make_key(kStage, kVersion, inputs);
  store.keep(key, survey);
  return key.digest;
}

std::optional<MeasuredSurvey> load_measured(const std::string& digest, const store::Store& store) {
  return store.load<MeasuredSurvey>({kStage, digest});
}

Result<int> scan_id_of(const MeasuredSurvey& survey, const std::string& name) {
  const std::array<std::function<bool(const std::string&)>, 3> rules = {
      [&](const std::string& scan) { return scan == name || io::percent_decoded(scan) == name; },
      [&](const std::string& scan) { return fs::path(io::percent_decoded(scan)).filename() == name; },
      [&](const std::string& scan) { return fs::path(io::percent_decoded(scan)).stem() == name; }};
  for (const auto& rule : rules) {
    const std::vector<int> ids = ids_where(survey, rule);
    if (ids.size() == 1) return ids.front();
    if (ids.size() > 1) {
      return fail(fmt::format("'{}' names {} scans", name, ids.size()), {},
                  fmt::format("give the whole name as in scans.csv, such as {}",
                              survey.scans[static_cast<std::size_t>(ids.front())].name));
    }
  }
  std::vector<std::string> names;
  for (const report::ScanRecord& scan : survey.scans) names.push_back(scan.name);
  const std::string nearest = config::nearest_word(name, names);
  return fail(fmt::format("the survey has no scan '{}'", name), {},
              nearest.empty() ? "the names are in scans.csv" : "did you mean " + nearest + "?");
}

}  // namespace isthmus::pipelines
