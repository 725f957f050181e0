// The files of the output contract that are made from a SurveyRecord.
#pragma once

#include <filesystem>

#include "base/error.h"
#include "report/survey_record.h"

namespace isthmus::report {

/// Writes scans.csv, poses.txt, pose_graph.g2o, links.csv, covariances.csv, timings.csv, report.html, report.json and
/// run.json into
/// `folder` (created if missing), each by rename; run.json last: where it is, the others are.
Result<void> write_outputs(const SurveyRecord& record, const std::filesystem::path& folder);

}  // namespace isthmus::report
