// report.html: one self-contained page for the surveyor, readable offline, in light and dark, and on paper.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// Verdict first, then the plan map, what is missing and what would join it, matrix, histograms, tables, settings. The
/// page loads nothing from anywhere; its small script only sorts, filters and recolours.
std::string html_report(const SurveyRecord& record);

}  // namespace isthmus::report
