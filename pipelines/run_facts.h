// What the record of a run says about the run itself.
#pragma once

#include <cstdint>
#include <string>

#include "report/survey_record.h"

namespace isthmus::pipelines {

/// Command, time of day and host.
report::RunRecord begun_run(const std::string& command);
/// The most memory that this process has held.
std::uint64_t peak_memory_bytes();

}  // namespace isthmus::pipelines
