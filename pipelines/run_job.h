// A job from its input folder to its output folder: list, run, write.
#pragma once

#include <atomic>
#include <string>

#include "pipelines/events.h"
#include "pipelines/job.h"
#include "report/survey_record.h"

namespace isthmus::pipelines {

enum class JobEnd {
  connected,    ///< all scans in one component
  unconnected,  ///< finished, but scans or parts are unconnected or unreadable
  stopped,      ///< asked to stop: nothing was written but products in the store
};

struct JobResult {
  JobEnd end = JobEnd::stopped;
  report::SurveyRecord record;
  std::size_t num_made = 0;   ///< products computed
  std::size_t num_found = 0;  ///< products found in the store
};

/// Writes every file of the output contract (docs/outputs.md) unless it was stopped. Fails when the input is not there
/// or holds no scans, or when the output cannot be written. `command` is what the record says was run.
Result<JobResult> run_job(const Job& job, const std::string& command, const Events& events,
                          const std::atomic<bool>& stop);

}  // namespace isthmus::pipelines
