// scans.csv, links.csv, covariances.csv and timings.csv; columns are described in docs/outputs.md.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

std::string scans_csv(const SurveyRecord& record);
std::string links_csv(const SurveyRecord& record);
std::string covariances_csv(const SurveyRecord& record);
std::string timings_csv(const SurveyRecord& record);

}  // namespace isthmus::report
