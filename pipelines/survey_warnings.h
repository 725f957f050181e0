// What a person should know of a finished survey beyond its tables, in a fixed order.
#pragma once

#include <string>
#include <vector>

#include "report/survey_record.h"

namespace isthmus::pipelines {

/// Notes of scans that are no matter of course (no free space, odd headers), pairs that could not be computed, and what
/// hangs apart. Equal words of several scans are one warning. Deterministic: by scan ids, then by pairs, then parts.
std::vector<std::string> survey_warnings(const report::SurveyRecord& record);

}  // namespace isthmus::pipelines
