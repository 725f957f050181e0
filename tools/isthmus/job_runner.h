// Runs jobs one after the other and says in the end how each went.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/run_job.h"
#include "terminal.h"

namespace isthmus::cli {

/// Catches stop signals meanwhile. Exit code of the batch: failure if a job failed, else unconnected if one is, else
/// success.
int run_jobs(const std::vector<pipelines::Job>& jobs, const std::string& command, Terminal& terminal);

/// One line: what hangs together, and where the report is.
std::string summary_of(const pipelines::JobResult& result, const std::filesystem::path& out);

}  // namespace isthmus::cli
