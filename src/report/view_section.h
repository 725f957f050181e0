// The 3D view in report.html: its controls, its data and its script.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// Without a cloud of a placed scan: why, or empty where the build has no view.
std::string view_section(const SurveyRecord& record);

/// The script that makes the section live; belongs behind the page's own. Empty likewise.
std::string view_script(const SurveyRecord& record);

/// What the script reads, as JSON: parts, stations with their clouds, links.
std::string view_data(const SurveyRecord& record);

}  // namespace isthmus::report
