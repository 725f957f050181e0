// A set of scans with ground truth, turned at random, with its products in memory.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/degrade.h"
#include "evaluate/inputs.h"
#include "pipelines/settings.h"

namespace isthmus::bench {

/// How the scans of a set are moved before anything sees them.
enum class Scramble {
  none,
  yaw,     ///< about the vertical through the origin
  full,    ///< about the origin, uniform in SO(3)
  object,  ///< full, and shifted by up to its extent: the origin is no station
};
std::optional<Scramble> scramble_from(const std::string& word);

struct SetPlace {
  std::filesystem::path folder;
  Scramble scramble = Scramble::full;
};
/// "DIR" or "DIR:none|yaw|full|object".
Result<SetPlace> set_place_from(const std::string& text);

/// Copies the set to `to` as PLY, each scan made worse by `degradation` and moved by a transform drawn from the seed
/// and its name, with poses.gt.txt and overlaps.gt.txt (those of the scans as they were; computed with `voxel_m` if the
/// set has none). Of scans with unlike densities only the pairs of a thinned and a whole one are listed. A folder that
/// is already there is taken as it is.
Result<void> scramble_set(const SetPlace& set, std::uint64_t seed, std::optional<double> voxel_m,
                          const Degradation& degradation, const std::filesystem::path& to);

struct BenchScan {
  std::string name;
  Transform common_from_scan = Transform::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< scan frame, as the evaluation measures errors there
  ScanProduct product;
};

struct BenchSet {
  std::string name;
  double evaluation_voxel_m = 0;
  std::vector<BenchScan> scans;
  std::map<std::pair<std::size_t, std::size_t>, double> overlap;  ///< of (smaller, larger) index
};

/// Reads, reduces and describes every scan in parallel.
Result<BenchSet> load_set(const std::filesystem::path& folder, const pipelines::Settings& settings);

}  // namespace isthmus::bench
