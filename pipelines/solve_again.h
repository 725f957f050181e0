// A finished survey is solved again from what its run measured; nothing is registered, no scan is read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/job.h"
#include "pipelines/measured_survey.h"
#include "pipelines/run_job.h"

namespace isthmus::pipelines {

/// Names are as a person gives them.
struct LinkToTakeOut {
  std::string a, b;
};
struct LinkToAdd {
  std::string source, target;
  std::filesystem::path
      matrix;  ///< 3x4 or 4x4, row by row: source's coordinates -> target's, as `isthmus pair -o` writes it
};

struct SolveEdits {
  std::vector<LinkToTakeOut> take_out;
  std::vector<LinkToAdd> add;
  std::vector<std::string> assignments;  ///< "solve.key=value"
  std::filesystem::path control;         ///< file; empty: that of the run, if it had one
};

/// What a finished run left behind.
struct FinishedRun {
  Job job;  ///< from OUT/resolved.yaml, its output where OUT is now
  MeasuredSurvey measured;
  std::string measured_digest;
  MeasuredSurvey edited;      ///< as OUT was solved last
  std::string settings_yaml;  ///< likewise
};

/// Fails when OUT is no finished survey, or when its store is gone; says which file tells so.
Result<FinishedRun> load_finished_run(const std::filesystem::path& out, const Events& events);

/// Marks and adds links. Fails on unknown scans, pairs without a link, and matrices that are none or not rigid.
Result<void> apply_edits(const SolveEdits& edits, MeasuredSurvey& measured);

/// Writes every output file of `register` but resolved.yaml, which goes on to repeat the registration. Each call starts
/// from what was measured: edits of an earlier one are forgotten.
Result<JobResult> solve_again(const std::filesystem::path& out, const SolveEdits& edits, const std::string& command,
                              const Events& events);

/// The survey as OUT shows it, solved as it was solved last; the section `run` is empty.
Result<report::SurveyRecord> record_as_solved(FinishedRun finished);

}  // namespace isthmus::pipelines
