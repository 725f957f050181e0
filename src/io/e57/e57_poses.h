// New poses for the scans of an E57 file.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::io {

/// Copies the file with file_from_scan[k] as the pose of scan k (in the order of the file); an absent one leaves that
/// scan as it is. Images that belong to a scan move with it. Only the XML section and the header are written anew: the
/// points (and images) are the same bytes at the same places. `to` may be `from`. Fails if there are more or fewer
/// scans, or if any page of `from` is damaged.
Result<void> copy_e57_with_poses(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const std::vector<std::optional<Transform>>& file_from_scan);

}  // namespace isthmus::io
