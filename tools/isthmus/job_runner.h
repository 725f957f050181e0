// Runs jobs one after the other and says in the end how each went.
#pragma once

#include <string>
#include <vector>

#include "pipelines/job.h"
#include "terminal.h"

namespace isthmus::cli {

/// Catches stop signals meanwhile. Exit code of the batch: failure if a job failed, else unconnected if one is, else
/// success.
int run_jobs(const std::vector<pipelines::Job>& jobs, const std::string& command, Terminal& terminal);

}  // namespace isthmus::cli
