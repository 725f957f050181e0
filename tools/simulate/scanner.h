// The scanner: a spherical grid of rays from one station becomes points in the scanner's own frame.
#pragma once

#include <cstdint>

#include "io/scan_reader.h"
#include "simulate/ray_scene.h"

namespace isthmus::sim {

/// What the instrument does to the truth. Defaults are a quiet mid-range phase scanner.
struct ScannerModel {
  double step_rad = 0.1 * 3.14159265358979323846 / 180;  ///< between neighbouring rays, both ways
  double min_range_m = 0.4;
  double max_range_m = 80;
  double noise_m = 0.002;       ///< sigma of the range
  double noise_per_m = 10e-6;   ///< added to that sigma per metre of range
  double beam_rad = 0.3e-3;     ///< full divergence: decides how many beams straddle an edge; 0 = no mixed pixels
  double dropouts = 0.002;      ///< share of returns lost for no reason
  bool signal_loss = true;      ///< dark or grazing surfaces lose returns
  bool glass = true;            ///< false: panes are invisible
  bool keep_no_return = false;  ///< a ray without a return gives a point at the origin instead of none
};

/// One set-up of the instrument.
struct Station {
  Transform common_from_instrument =
      Transform::Identity();                               ///< levelled up to its tilt; the rays' pattern belongs to it
  Transform scan_from_instrument = Transform::Identity();  ///< a turn of the written coordinates, no translation
  std::uint64_t seed = 0;                                  ///< of all randomness of this scan
};

/// What can be hit from a station: the place, and what moved into it for this scan only.
struct World {
  const RayScene* fixed = nullptr;
  const RayScene* moving = nullptr;
};

struct Grid {
  int rows = 0;     ///< elevation from +90 degrees down to -60
  int columns = 0;  ///< azimuth, a full turn
};
Grid grid_of(double step_rad);

/// Points of a whole scan, row by row from the zenith, in the scan frame. Every ray draws its own random numbers from
/// (station seed, ray), so the result does not depend on the number of threads.
io::PointChunk scan_from(const Station& station, const World& world, const ScannerModel& model);

}  // namespace isthmus::sim
