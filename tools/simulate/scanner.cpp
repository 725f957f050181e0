#include "simulate/scanner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/rng.h"

namespace isthmus::sim {
namespace {

constexpr double kTopElevation_rad = std::numbers::pi / 2;
constexpr double kBottomElevation_rad = -std::numbers::pi / 3;  // the tripod hides what is below
constexpr int kRowsPerBand = 32;  // one extra row is traced per band, to know the neighbours below

/// What one beam brought back; range 0 = nothing.
struct Shot {
  float range_m = 0;
  float reflectivity = 0;  ///< of the surface, times what glass let through
  float cosine = 0;        ///< of the incidence angle
};
using Row = std::vector<Shot>;

/// A stream of random numbers that belongs to one ray; `purpose` separates glass from noise.
Rng rng_of_ray(const Station& station, std::uint64_t ray, std::uint64_t purpose) {
  constexpr std::uint64_t kOdd =
      0xD1342543DE82EF95ULL;  // not the generator's own increment: streams must not be shifts
  return Rng(Rng(station.seed ^ ((2 * ray + purpose + 1) * kOdd)).next());
}

struct Directions {
  std::vector<double> cosine, sine;  ///< of each column's azimuth
};

/// Everything the rows share.
struct Job {
  const Station& station;
  const World& world;
  const ScannerModel& model;
  Grid grid;
  Directions columns;

  [[nodiscard]] Vector3d in_instrument(int row, int column) const {
    const double elevation = kTopElevation_rad - row * model.step_rad;
    const double level = std::cos(elevation);
    return {level * columns.cosine[column], level * columns.sine[column], std::sin(elevation)};
  }
};

std::optional<Hit> nearest(const World& world, const Vector3d& from, const Vector3d& direction, double far_m) {
  constexpr double kSelf_m = 1e-3;  // leave the surface one starts from
  std::optional<Hit> hit = world.fixed->trace(from, direction, kSelf_m, far_m);
  if (world.moving != nullptr) {
    const std::optional<Hit> moved = world.moving->trace(from, direction, kSelf_m, hit ? hit->range_m : far_m);
    if (moved) hit = moved;
  }
  return hit;
}

Shot shot_of(const Hit& hit, const Vector3d& direction, double travelled_m, double transmission) {
  return {static_cast<float>(travelled_m), static_cast<float>(transmission * reflectivity_of(hit.material)),
          static_cast<float>(std::abs(hit.normal.dot(direction)))};
}

/// Follows a beam that met a pane: through it, back from it, or off it into a ghost behind the pane. Reflectance is
/// Schlick's approximation (1994) of Fresnel's for the two faces of a pane; the shares that get lost are rough.
Shot through_glass(const Job& job, Vector3d from, Vector3d direction, Hit pane, Rng& rng) {
  constexpr double kNormalReflectance = 0.08, kLost = 0.12, kDirt = 0.01, kMirrorCosine = 0.995;
  constexpr int kMaxPanes = 4;
  const double far_m = job.model.max_range_m;
  double travelled_m = 0, transmission = 1;
  for (int k = 0; k < kMaxPanes; ++k) {
    travelled_m += pane.range_m;
    if (job.model.glass) {
      const double cosine = std::abs(pane.normal.dot(direction));
      const double reflectance = kNormalReflectance + (1 - kNormalReflectance) * std::pow(1 - cosine, 5);
      const double u = rng.uniform();
      if (cosine > kMirrorCosine || u < kDirt) return shot_of(pane, direction, travelled_m, 1.0);
      if (u < kDirt + kLost) return {};
      const bool reflected = u < kDirt + kLost + reflectance;
      from += pane.range_m * direction;
      if (reflected) direction -= 2 * pane.normal.dot(direction) * pane.normal;
      transmission *= reflected ? 0.5 : 0.8;
    } else {
      from += pane.range_m * direction;
    }
    const std::optional<Hit> next = nearest(job.world, from, direction, far_m - travelled_m);
    if (!next) return {};
    if (next->material != Material::glass) {
      return shot_of(*next, direction, travelled_m + next->range_m, transmission);
    }
    pane = *next;
  }
  return {};
}

/// One scan line of noise-free shots.
void trace_row(const Job& job, int row, Row& shots) {
  const Vector3d origin = job.station.common_from_instrument.translation();
  const Eigen::Matrix3d turn = job.station.common_from_instrument.linear();
  const auto far_m = static_cast<float>(job.model.max_range_m);
  shots.assign(static_cast<std::size_t>(job.grid.columns), Shot{});
  std::array<RawHit, kPacket> hits, moved;
  std::array<Vector3d, kPacket> directions;
  for (int first = 0; first < job.grid.columns; first += kPacket) {
    Packet packet;
    packet.count = std::min(kPacket, job.grid.columns - first);
    for (int k = 0; k < packet.count; ++k) {
      directions[k] = turn * job.in_instrument(row, first + k);
      packet.x[k] = static_cast<float>(directions[k].x());
      packet.y[k] = static_cast<float>(directions[k].y());
      packet.z[k] = static_cast<float>(directions[k].z());
    }
    job.world.fixed->trace(origin, packet, far_m, hits);
    if (job.world.moving != nullptr) job.world.moving->trace(origin, packet, far_m, moved);
    for (int k = 0; k < packet.count; ++k) {
      const bool is_moved = job.world.moving != nullptr && moved[k].triangle != RawHit::kNone &&
                            (hits[k].triangle == RawHit::kNone || moved[k].range_m < hits[k].range_m);
      const RawHit& raw = is_moved ? moved[k] : hits[k];
      if (raw.triangle == RawHit::kNone) continue;
      const Hit hit = (is_moved ? job.world.moving : job.world.fixed)->resolve(origin, directions[k], raw);
      if (hit.material == Material::glass) {
        Rng rng = rng_of_ray(job.station, static_cast<std::uint64_t>(row) * job.grid.columns + first + k, 0);
        shots[first + k] = through_glass(job, origin, directions[k], hit, rng);
      } else {
        shots[first + k] = shot_of(hit, directions[k], hit.range_m, 1.0);
      }
    }
  }
}

/// A beam straddles the edge to one of its neighbours with the probability that its footprint reaches over; then the
/// instrument sees both surfaces at once and reports something between, weighted by how much of the beam falls on each.
float range_with_edges(const Shot& shot, const Shot& right, const Shot& below, double straddle, double divergence_rad,
                       Rng& rng) {
  constexpr float kBlend_m = 2.5F;  // echoes further apart than a pulse are told apart: the first is reported
  const double u = rng.uniform();
  if (u >= 2 * straddle) return shot.range_m;
  const Shot& other = u < straddle ? right : below;
  const float gap = other.range_m - shot.range_m;
  const bool is_edge =
      other.range_m > 0 && std::abs(gap) > 0.05F + 4 * static_cast<float>(divergence_rad) * shot.range_m;
  if (!is_edge) return shot.range_m;
  if (std::abs(gap) > kBlend_m) return std::min(shot.range_m, other.range_m);
  return shot.range_m + static_cast<float>(rng.uniform()) * gap;
}

/// Does too little light come back? Signal falls with the square of the range; a diffuse target of reflectivity 0.2 met
/// at 45 degrees is just kept at the greatest range (the way data sheets state it), below that returns thin out.
bool is_lost(const Shot& shot, const ScannerModel& model, Rng& rng) {
  const double u = rng.uniform();
  if (u < model.dropouts) return true;
  if (!model.signal_loss) return false;
  constexpr double kEnough = 0.14, kGrazingCosine = 0.03, kGrazingLoss = 0.6;
  const double relative_range = shot.range_m / model.max_range_m;
  const double signal = shot.reflectivity * shot.cosine / std::max(relative_range * relative_range, 1e-4);
  return u < std::max(1 - signal / kEnough, shot.cosine < kGrazingCosine ? kGrazingLoss : 0.0);
}

/// Range-compensated brightness, 0 to 1: diffuse reflection with 5 % speckle.
float intensity_of(const Shot& shot, Rng& rng) {
  constexpr double kSpeckle = 0.05;
  return static_cast<float>(std::clamp(shot.reflectivity * shot.cosine * (1 + kSpeckle * rng.normal()), 0.0, 1.0));
}

void append_point(const Job& job, int row, int column, const Row& shots, const Row& below, io::PointChunk& points) {
  const auto nothing = [&] {
    if (!job.model.keep_no_return) return;
    points.points.emplace_back(Eigen::Vector3f::Zero());
    points.intensity.push_back(0);
  };
  Shot shot = shots[column];
  if (shot.range_m <= 0) return nothing();
  Rng rng = rng_of_ray(job.station, static_cast<std::uint64_t>(row) * job.grid.columns + column, 1);
  if (is_lost(shot, job.model, rng)) return nothing();
  const double straddle = std::min(0.5, 0.5 * job.model.beam_rad / job.model.step_rad);
  const Shot& right = shots[(column + 1) % job.grid.columns];
  shot.range_m = range_with_edges(shot, right, below[column], straddle, job.model.beam_rad, rng);
  const double sigma_m = job.model.noise_m + job.model.noise_per_m * shot.range_m;
  const double range_m = shot.range_m + sigma_m * rng.normal();
  if (range_m < job.model.min_range_m || range_m > job.model.max_range_m) return nothing();
  const Vector3d p_in_scan = job.station.scan_from_instrument.linear() * (range_m * job.in_instrument(row, column));
  points.points.emplace_back(p_in_scan.cast<float>());
  points.intensity.push_back(intensity_of(shot, rng));
}

io::PointChunk band_of_rows(const Job& job, int first_row, int last_row) {
  io::PointChunk points;
  Row shots, below;
  trace_row(job, first_row, shots);
  for (int row = first_row; row < last_row; ++row) {
    trace_row(job, std::min(row + 1, job.grid.rows - 1), below);
    for (int column = 0; column < job.grid.columns; ++column) append_point(job, row, column, shots, below, points);
    shots.swap(below);
  }
  return points;
}

}  // namespace

Grid grid_of(double step_rad) {
  // A hair more than the quotient, so that 0.1 degrees gives 3600 columns whatever the rounding.
  constexpr double kHair = 1e-6;
  return {static_cast<int>((kTopElevation_rad - kBottomElevation_rad) / step_rad + kHair) + 1,
          std::max(1, static_cast<int>(2 * std::numbers::pi / step_rad + kHair))};
}

io::PointChunk scan_from(const Station& station, const World& world, const ScannerModel& model) {
  const Grid grid = grid_of(model.step_rad);
  Job job{station, world, model, grid, {}};
  for (int column = 0; column < grid.columns; ++column) {
    job.columns.cosine.push_back(std::cos(column * model.step_rad));
    job.columns.sine.push_back(std::sin(column * model.step_rad));
  }
  const auto num_bands = static_cast<std::size_t>((grid.rows + kRowsPerBand - 1) / kRowsPerBand);
  std::vector<io::PointChunk> bands(num_bands);
  parallel_for_index(num_bands, 1, [&](std::size_t band) {
    const int first = static_cast<int>(band) * kRowsPerBand;
    bands[band] = band_of_rows(job, first, std::min(first + kRowsPerBand, grid.rows));
  });
  io::PointChunk scan;
  for (io::PointChunk& band : bands) {
    scan.points.insert(scan.points.end(), band.points.begin(), band.points.end());
    scan.intensity.insert(scan.intensity.end(), band.intensity.begin(), band.intensity.end());
    band = {};
  }
  return scan;
}

}  // namespace isthmus::sim
