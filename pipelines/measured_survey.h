// All that registering measured, before anything is solved: kept in the store so that a finished survey can be solved
// again.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "report/survey_record.h"
#include "store/store.h"

namespace isthmus::pipelines {

/// Where the products that make a scan's cloud for the 3D view lie in the store.
struct ViewKeys {
  int id = 0;
  store::Key sampled, intensity;

  template <class F>
  void fields(F&& f) {
    f(id), f(sampled), f(intensity);
  }
};

struct MeasuredSurvey {
  std::string title;
  PoseGraph graph;                        ///< of the scans that did not fail, with the verdicts of the pair stage
  std::vector<report::ScanRecord> scans;  ///< ascending ids, failed ones too; not judged
  std::vector<std::string> warnings;      ///< of listing, reading and registering
  std::vector<ViewKeys> view_keys;        ///< ascending ids, of the scans that did not fail

  template <class F>
  void fields(F&& f) {
    f(title), f(graph), f(scans), f(warnings), f(view_keys);
  }
};

/// Keeps it under the digest of its content but for the running times; run.json names it. Trouble is reported through
/// the store.
std::string keep_measured(const MeasuredSurvey& survey, const store::Store& store);

std::optional<MeasuredSurvey> load_measured(const std::string& digest, const store::Store& store);

/// The id of the scan that a person names: by its name in the outputs, or by the file's name, with or without
/// extension, where that is one scan's. Else an error with the nearest name.
Result<int> scan_id_of(const MeasuredSurvey& survey, const std::string& name);

}  // namespace isthmus::pipelines
