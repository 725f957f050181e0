// The verdict on a survey in words: what a person reads first.
#pragma once

#include <string>
#include <vector>

#include "report/run_json.h"
#include "report/survey_record.h"

namespace isthmus::report {

struct Headline {
  const char* grade;  ///< "good", "partly", "bad"
  std::string text;
};
Headline headline(const SurveyCounts& counts);

/// What is not joined, how the links came out, which of them nothing confirms, what was changed by hand. Plain text.
std::string summary_text(const SurveyRecord& record, const SurveyCounts& counts);

/// 0 for none.
double median_of(std::vector<double> values);

/// A value of every accepted link.
template <class Value>
std::vector<double> of_accepted(const SurveyRecord& record, Value value) {
  std::vector<double> out;
  for (const SolvedLink& l : record.solution.links)
    if (l.link.result.verdict == Verdict::accepted) out.push_back(value(l));
  return out;
}

}  // namespace isthmus::report
