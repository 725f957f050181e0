// A survey that never happened: a made-up place, a made-up scanner, and the exact truth about both.
//
// Writes scan_000.ply ... (x y z intensity, each in the scanner's own frame with the station at the
// origin), poses.gt.txt (name r00 r01 r02 tx ... tz, scan -> common, metres) and, when asked, foreign.txt: scans of
// other places; and simulation.yaml, the options and the names of these files. Theory, sources and examples:
// docs/simulate.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "config/option_table.h"

namespace isthmus {

struct SimulateOptions {
  std::string scene = "office";
  std::string output;
  std::string format = "ply";
  int stations = 10;
  double resolution_deg = 0.1;
  int seed = 1;
  std::optional<double> spacing_m;
  std::string orientation = "yaw";
  double tilt_deg = 0.02;
  double min_range_m = 0.4;
  double max_range_m = 80.0;
  double noise_m = 0.002;
  double noise_ppm = 10.0;
  double beam_mrad = 0.3;
  double dropouts = 0.002;
  bool signal_loss = true;
  bool glass = true;
  bool movers = true;
  bool keep_no_return = false;
  int foreign = 0;
};
const config::OptionTable<SimulateOptions>& simulate_options_table();

struct SimulatedScan {
  std::string name;  ///< file name within the output folder
  std::uint64_t num_rays = 0;
  std::uint64_t num_points = 0;  ///< points written
  bool foreign = false;          ///< of another place: absent from poses.gt.txt
};

struct SimulationSummary {
  std::vector<SimulatedScan> scans;  ///< in the order of their names
  double spacing_m = 0;              ///< as used
  std::uint64_t num_triangles = 0;   ///< of the scene all but the foreign scans share
};

/// Called after each scan is on disk, in the order of the scans, from the calling thread.
using SimulationProgress = std::function<void(const SimulatedScan& scan, std::size_t done, std::size_t total)>;

/// Same options, same bytes, for any number of threads (TBB loops in the caller's arena). Creates the output folder.
/// What an earlier simulation made in it is removed first; a folder that holds something and was not made by a
/// simulation is refused. Fails if an option is outside its table's range, if a place for a station cannot be found, or
/// on the first file it cannot write.
Result<SimulationSummary> simulate(const SimulateOptions& options, const SimulationProgress& progress = {});

}  // namespace isthmus
