// Where the stations stood, as far as somebody knows: near pairs are tried first (docs/stages/candidates.md).
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace isthmus::pipelines {

/// Positions in metres; in which frame is up to the file that they are from.
struct ScanPositions {
  std::map<std::string, Eigen::Vector3d> by_name;  ///< of scans, as in scans.csv
  std::vector<std::string> warnings;               ///< rows that name no scan of the survey
};

/// From a CSV file with a first line that names its columns: scan, x, y and, if known, z. Other columns may stand
/// beside them. Scans are named as in scans.csv, or by their file's name with or without its extension. An empty path
/// is no positions. Errors name line and value.
Result<ScanPositions> read_positions(const std::string& file, std::span<const std::string> scans);

/// What the files of the scans store, by name. Where several stand at the origin it is no position but the pose of
/// files that know none; positions that do not lie at least a metre apart tell nothing: then there are none.
ScanPositions positions_of_files(std::span<const std::pair<std::string, std::optional<Eigen::Vector3d>>> stored);

/// Where the scanner stood, each in the coordinates of its scan's own file (sampling.stations): read_positions() with
/// heights.
Result<ScanPositions> read_stations(const std::string& file, std::span<const std::string> scans);

}  // namespace isthmus::pipelines
