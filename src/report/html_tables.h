// The link table, the scan table, and the list of what is missing with what would join it.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

std::string link_table(const SurveyRecord& record);
std::string scan_table(const SurveyRecord& record);

/// Known points, poses and levels with their errors; empty without control.
std::string control_section(const SurveyRecord& record);

/// Scans that failed, and parts beside the largest one with the link that came nearest to joining each; empty if none.
std::string missing_section(const SurveyRecord& record);

}  // namespace isthmus::report
