// New poses for the scans of an E57 file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::io {

/// What becomes of scans for which no pose is given.
enum class ScansWithoutPose : std::uint8_t { kept_as_they_are, left_out };

/// Copies the file with file_from_scan[k] as the pose of scan k (in the order of the file). Images that belong to a
/// scan move with it, or are left out with it. Only the XML section and the header are written anew: all points and
/// images are the same bytes at the same places. `coordinates`, if not empty, becomes the file's coordinateMetadata:
/// the reference system that the poses lead to. `to` may be `from`. Fails if there are more or fewer scans, or if any
/// page of `from` is damaged.
Result<void> copy_e57_with_poses(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const std::vector<std::optional<Transform>>& file_from_scan,
                                 ScansWithoutPose without = ScansWithoutPose::kept_as_they_are,
                                 const std::string& coordinates = {});

}  // namespace isthmus::io
