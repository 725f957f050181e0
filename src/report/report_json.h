// report.json: what report.html says, for programs. Fields in docs/outputs.md.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

std::string report_json(const SurveyRecord& record);

}  // namespace isthmus::report
