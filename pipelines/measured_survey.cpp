#include "pipelines/measured_survey.h"

#include <array>

#include "base/digest.h"
#include "pipelines/scan_names.h"

namespace isthmus::pipelines {
namespace {

constexpr const char* kStage = "survey";
constexpr const char* kVersion = "4";  // of the form of MeasuredSurvey in the store

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
  std::vector<std::string> names;
  for (const report::ScanRecord& scan : survey.scans) names.push_back(scan.name);
  return index_of_scan(names, name).map([&](std::size_t at) { return survey.scans[at].id; });
}

}  // namespace isthmus::pipelines
