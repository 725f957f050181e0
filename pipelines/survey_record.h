// From what a pipeline knows to what the outputs say.
#pragma once

#include "pipelines/job.h"
#include "pipelines/survey_pipeline.h"
#include "report/survey_record.h"

namespace isthmus::pipelines {

/// Everything but the section `run`. Moves the solution out of the outcome.
report::SurveyRecord record_of(const Job& job, SurveyOutcome outcome);

}  // namespace isthmus::pipelines
