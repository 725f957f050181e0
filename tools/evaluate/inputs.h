// The text files an evaluation reads.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::evaluate {

using Poses = std::vector<std::pair<std::string, Transform>>;  ///< in the file's order
using PairKey = std::pair<std::string, std::string>;           ///< smaller name first

inline PairKey pair_key(const std::string& a, const std::string& b) { return a < b ? PairKey(a, b) : PairKey(b, a); }

struct Overlaps {
  std::optional<double> voxel_m;
  std::map<PairKey, double> of;
};

struct Edge {
  int from = 0;  ///< target
  int to = 0;    ///< source
  Transform from_to = Transform::Identity();
};

struct ScanRow {
  int id = 0;
  std::string name;       ///< file name without folders, decoded
  std::string component;  ///< as written; may be empty
  std::optional<double> voxel_m;
};

/// Lines of 13 words; others and those that begin with # are skipped.
Result<Poses> read_poses(const std::filesystem::path& path);
Result<Overlaps> read_overlaps(const std::filesystem::path& path);
Result<std::vector<Edge>> read_g2o_edges(const std::filesystem::path& path);
Result<std::vector<ScanRow>> read_scans_csv(const std::filesystem::path& path);

/// Rows of RFC 4180 text.
std::vector<std::vector<std::string>> parse_csv(const std::string& text);

/// Last path component of a percent-encoded scan name, decoded.
std::string file_name_of(const std::string& scan_name);

}  // namespace isthmus::evaluate
