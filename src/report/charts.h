// The pair matrix, histograms and stage times as SVG and HTML.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// A square per pair, scans ordered by component: below the diagonal the verdict, above it the overlap.
std::string pair_matrix(const SurveyRecord& record);

std::string overlap_histogram(const SurveyRecord& record);
std::string residual_histogram(const SurveyRecord& record);

/// Seconds by stage, summed over scans and pairs.
std::string stage_times(const SurveyRecord& record);

}  // namespace isthmus::report
