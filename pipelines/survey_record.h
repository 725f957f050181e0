// From what a pipeline knows to what the outputs say.
#pragma once

#include "pipelines/job.h"
#include "pipelines/measured_survey.h"
#include "pipelines/survey_pipeline.h"
#include "report/survey_record.h"

namespace isthmus::pipelines {

/// What is kept for solving again. `of_listing`: warnings from before the scans were read.
MeasuredSurvey measured_of(const Job& job, const SurveyOutcome& outcome, const std::vector<std::string>& of_listing);

/// Everything but the section `run`.
report::SurveyRecord record_of(const Job& job, const MeasuredSurvey& measured, Solution solution);

}  // namespace isthmus::pipelines
