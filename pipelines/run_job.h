// A job from its input folder to its output folder: list, run, write.
#pragma once

#include <atomic>
#include <string>

#include "io/scan_directory.h"
#include "pipelines/events.h"
#include "pipelines/job.h"
#include "report/survey_record.h"

namespace isthmus::pipelines {

enum class JobEnd {
  connected,    ///< all scans in one component
  unconnected,  ///< finished, but scans or parts are unconnected or unreadable
  shared,       ///< a shard: everything of the survey is in the store, a whole run collects it
  unfinished,   ///< a shard: its share is in the store as far as what others owe is there
  stopped,      ///< asked to stop: nothing was written but products in the store
};

struct JobResult {
  JobEnd end = JobEnd::stopped;
  report::SurveyRecord record;
  std::size_t num_made = 0;     ///< products computed
  std::size_t num_found = 0;    ///< products found in the store
  std::size_t num_missing = 0;  ///< of a shard: what others still owe
};

/// Writes every file of the output contract (docs/outputs.md) unless it was stopped or is a shard. Fails when the input
/// is not there or holds no scans, or when the output cannot be written. `command` is what the record says was run.
Result<JobResult> run_job(const Job& job, const std::string& command, const Events& events,
                          const std::atomic<bool>& stop);

/// The scans of a job: what is in its inputs but not in its output or store. Fails when there are none.
Result<io::ScanListing> scans_of_job(const Job& job);

JobEnd end_of(const report::SurveyRecord& record);

/// The paths of the input, one after the other.
std::string text_of_inputs(const Job& job);

/// Warnings of the finished survey, behind those that the record holds already; all but the latter are told.
void complete_warnings(report::SurveyRecord& record, const Events& events);

}  // namespace isthmus::pipelines
