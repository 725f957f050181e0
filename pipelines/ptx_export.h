// Registered scans as PTX with their poses filled in.
#pragma once

#include <filesystem>
#include <vector>

#include "base/error.h"
#include "pipelines/e57_export.h"

namespace isthmus::pipelines {

/// All scans into one PTX file, streamed; the points stay in the scans' own frames.
Result<void> export_ptx(const std::filesystem::path& path, const std::vector<PlacedScan>& scans);

}  // namespace isthmus::pipelines
