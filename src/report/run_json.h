// run.json: versions, settings, counts, components and warnings; all that differs from run to run is in one section,
// "run".
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

std::string run_json(const SurveyRecord& record);

/// What the summary, the report and the program's last line count.
struct SurveyCounts {
  int scans = 0, placed = 0, unplaced = 0, failed = 0;
  int components = 0;  ///< of two or more scans
  int in_largest = 0;  ///< scans of component 0
  int pairs = 0, accepted = 0, ambiguous = 0, rejected = 0, pairs_failed = 0;
  int promoted = 0;   ///< accepted links that the pair stage had called ambiguous
  int overruled = 0;  ///< rejected links that the pair stage had accepted
  int confirmed = 0;  ///< accepted links in a loop
};
SurveyCounts count(const SurveyRecord& record);

}  // namespace isthmus::report
