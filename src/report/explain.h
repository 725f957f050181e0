// In words: why a scan or a pair is where it is.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// What holds the scan, which loops support it, what speaks against it, and what would join it if nothing does. Lines
/// of plain text.
std::string explain_scan(const SurveyRecord& record, int id);

/// Whether the pair was tried, with what evidence, what loops say, and where the poses put one scan in the other.
/// Precondition: a != b.
std::string explain_pair(const SurveyRecord& record, int a, int b);

}  // namespace isthmus::report
