#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_set>

#include "geometry/point_grid.h"
#include "scan/clutter.h"
#include "scan/free_space.h"
#include "scan/sampling.h"
#include "scan/station.h"
#include "scan/surface.h"
#include "scan/thinning.h"

namespace isthmus {
namespace {

constexpr std::uint32_t kCubeSize = 240;    // 0.4 degree cells; coarser where the scan is
constexpr int kFineRatio = 2;               // fine voxels a coarse voxel's edge: what is accumulated while streaming
constexpr std::uint32_t kMinFineCount = 3;  // median raw points a fine voxel below which the fine level is left out
constexpr std::uint32_t kMinVoxelNeighbours = 4;  // fewer voxels around (itself included): a stray point
constexpr double kLogRangeStep = 2e-4;            // relative width of a bin of the range histogram
constexpr double kSmallestRange = 1e-5;
constexpr std::size_t kRangeBins = 140000;  // up to 1e-5 * exp(28) m: beyond any range
// The origin is believed to be the station unless the points speak against it. Measured at true stations: up to 19 %
// blocked sight lines in thinned real scans, 35 % in furnished offices, concentration up to 0.81 (a SICK on a tilt
// unit); fused fragments and single views of objects have a concentration above 0.88.
constexpr double kMaxBlocked = 0.45;
constexpr double kMaxConcentration = 0.85;
// Closer than this, and not all round, it is an object before a camera in some frame of its own: no terrestrial scanner
// measures from there.
constexpr double kObjectRangeM = 1.0;
constexpr double kObjectConcentration = 0.4;

struct Voxel {
  std::uint64_t key = 0;
  std::uint32_t count = 0;
  float min_range_m = std::numeric_limits<float>::infinity();
  float max_range_m = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();                              // of offsets from the voxel's centre
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();  // xx xy xz yy yz zz of the same offsets
};

std::size_t range_bin(double range) {
  const double bin = std::log(range / kSmallestRange) / kLogRangeStep;
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kRangeBins - 1)));
}

// A shell is a spike at the far end of the ranges: at least 0.3 % of all points within 0.1 %, hardly a point beyond,
// and far denser than the ranges just before it (a tunnel's or a dome's wall is not).
std::optional<double> find_no_return_range(const std::vector<std::uint32_t>& histogram, std::uint64_t total) {
  constexpr std::size_t kHalf = 2, kContext = 100;
  constexpr std::uint64_t kMinShell = 30;  // in a small scan one far point is 0.3 %
  std::uint64_t beyond = 0;
  for (std::size_t bin = kRangeBins; bin-- > kContext + kHalf;) {
    if (histogram[bin] == 0) continue;
    if (beyond > total / 1000) return std::nullopt;
    std::uint64_t spike = 0, before = 0;
    for (std::size_t b = bin - 2 * kHalf; b <= bin; ++b) spike += histogram[b];
    for (std::size_t b = bin - kContext; b < bin - 2 * kHalf; ++b) before += histogram[b];
    const double density_ratio = static_cast<double>(spike) / (2 * kHalf + 1) /
                                 std::max(static_cast<double>(before) / (kContext - 2 * kHalf), 1e-9);
    if (spike >= kMinShell && static_cast<double>(spike) > 0.003 * static_cast<double>(total) && density_ratio > 20)
      return kSmallestRange * std::exp((static_cast<double>(bin) - kHalf + 0.5) * kLogRangeStep);
    beyond += histogram[bin];
  }
  return std::nullopt;
}

}  // namespace

struct VoxelSampler::State {
  SamplingOptions options;
  double voxel_m;       // of the scan
  double fine_voxel_m;  // of the accumulators
  Eigen::Vector3d local_origin_in_scan;
  std::optional<Eigen::Vector3f> candidate_station;  // local frame
  bool station_from_file = false;
  std::vector<Voxel> voxels;
  std::vector<std::uint32_t> slots;  // open addressing into voxels: index + 1
  std::size_t last =
      std::numeric_limits<std::size_t>::max();  // voxel of the previous point: neighbours in a file are close
  std::uint64_t num_read = 0, num_dropped = 0;
  FreeSpace raw;
  std::vector<std::uint32_t> ranges;
  Eigen::Vector3d ray_sum = Eigen::Vector3d::Zero();  // of the rays from the candidate station
  double sq_range_sum = 0;
  bool finished = false;

  Voxel& voxel(std::uint64_t key);
  void grow();
};

namespace {

std::uint64_t mixed(std::uint64_t key) {
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccdULL;
  return key ^ (key >> 33);
}

constexpr std::int64_t kKeyOffset = 1 << 20;

std::uint64_t voxel_key(const Eigen::Matrix<std::int64_t, 3, 1>& c) {
  return static_cast<std::uint64_t>(c[0] + kKeyOffset) << 42 | static_cast<std::uint64_t>(c[1] + kKeyOffset) << 21 |
         static_cast<std::uint64_t>(c[2] + kKeyOffset);
}

Eigen::Vector3d voxel_centre(std::uint64_t key, double voxel_m) {
  const auto part = [&](int shift) {
    return (static_cast<double>(static_cast<std::int64_t>(key >> shift & 0x1fffff) - kKeyOffset) + 0.5) * voxel_m;
  };
  return {part(42), part(21), part(0)};
}

}  // namespace

Voxel& VoxelSampler::State::voxel(std::uint64_t key) {
  if (last < voxels.size() && voxels[last].key == key) return voxels[last];
  if (voxels.size() * 2 >= slots.size()) grow();
  const std::uint64_t mask = slots.size() - 1;
  std::uint64_t slot = mixed(key) & mask;
  for (; slots[slot] != 0; slot = (slot + 1) & mask)
    if (voxels[slots[slot] - 1].key == key) {
      last = slots[slot] - 1;
      return voxels[last];
    }
  voxels.emplace_back().key = key;
  slots[slot] = static_cast<std::uint32_t>(voxels.size());
  last = voxels.size() - 1;
  return voxels[last];
}

void VoxelSampler::State::grow() {
  slots.assign(std::max<std::size_t>(1 << 12, slots.size() * 2), 0);
  const std::uint64_t mask = slots.size() - 1;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    std::uint64_t slot = mixed(voxels[i].key) & mask;
    while (slots[slot] != 0) slot = (slot + 1) & mask;
    slots[slot] = static_cast<std::uint32_t>(i + 1);
  }
}

VoxelSampler::VoxelSampler(const ScanHeader& header, double voxel_m, const SamplingOptions& options)
    : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->voxel_m = voxel_m;
  state_->fine_voxel_m = voxel_m / kFineRatio;
  state_->local_origin_in_scan = header.local_origin_in_scan;
  state_->station_from_file = header.station_in_scan.has_value();
  const Eigen::Vector3d station =
      header.station_in_scan.value_or(Eigen::Vector3d::Zero()) - header.local_origin_in_scan;
  if (options.station != "unknown" && (state_->station_from_file || header.local_origin_in_scan.isZero()))
    state_->candidate_station = station.cast<float>();
  state_->raw.size = kCubeSize;
  state_->raw.nearest_m.assign(6 * kCubeSize * kCubeSize, std::numeric_limits<float>::infinity());
  state_->ranges.assign(kRangeBins, 0);
  state_->grow();
}

VoxelSampler::~VoxelSampler() = default;

std::size_t VoxelSampler::bytes() const {
  return state_->voxels.capacity() * sizeof(Voxel) + state_->slots.capacity() * 4 + kRangeBins * 4 +
         state_->raw.nearest_m.size() * 4;
}

void VoxelSampler::add(const PointChunk& chunk) {
  State& s = *state_;
  const double inverse = 1.0 / s.fine_voxel_m;
  const double limit = (static_cast<double>(kKeyOffset) - kFineRatio) * s.fine_voxel_m;
  const Eigen::Vector3f zero_in_local = (-s.local_origin_in_scan).cast<float>();
  const Eigen::Vector3f station = s.candidate_station.value_or(Eigen::Vector3f::Zero());
  for (const Eigen::Vector3f& p : chunk.points) {
    ++s.num_read;
    if (!p.allFinite() || p == zero_in_local || p.cast<double>().cwiseAbs().maxCoeff() >= limit) {
      ++s.num_dropped;
      continue;
    }
    const Eigen::Vector3d q = p.cast<double>();
    const Eigen::Matrix<std::int64_t, 3, 1> cell = (q * inverse).array().floor().cast<std::int64_t>();
    const std::uint64_t key = voxel_key(cell);
    Voxel& v = s.voxel(key);
    const Eigen::Vector3d d = q - (cell.cast<double>().array() + 0.5).matrix() * s.fine_voxel_m;
    v.sum += d;
    v.squares +=
        (Eigen::Matrix<double, 6, 1>() << d[0] * d[0], d[0] * d[1], d[0] * d[2], d[1] * d[1], d[1] * d[2], d[2] * d[2])
            .finished();
    if (v.count < std::numeric_limits<std::uint32_t>::max()) ++v.count;
    if (s.candidate_station) {
      const Eigen::Vector3f ray = p - station;
      const float range = ray.norm();
      v.min_range_m = std::min(v.min_range_m, range);
      v.max_range_m = std::max(v.max_range_m, range);
      if (range > 0) {
        float& nearest = s.raw.nearest_m[cube_cell(ray, kCubeSize)];
        nearest = std::min(nearest, range);
        ++s.ranges[range_bin(range)];
        s.ray_sum += ray.cast<double>();
        s.sq_range_sum += static_cast<double>(range) * static_cast<double>(range);
      }
    }
  }
}

namespace {

VoxelMoments moments_of(const Voxel& v, double voxel_m) {
  const double n = v.count;
  const Eigen::Vector3d mean = v.sum / n;
  VoxelMoments out;
  out.mean = (voxel_centre(v.key, voxel_m) + mean).cast<float>();
  Eigen::Matrix3d second;
  second << v.squares[0], v.squares[1], v.squares[2], v.squares[1], v.squares[3], v.squares[4], v.squares[2],
      v.squares[4], v.squares[5];
  out.covariance = (second / n - mean * mean.transpose()).cast<float>();
  return out;
}

// Key of the coarse voxel that a fine one lies in.
std::uint64_t coarse_key(std::uint64_t fine_key) {
  const auto part = [&](int shift) {
    const auto cell = static_cast<std::int64_t>(fine_key >> shift & 0x1fffff) - kKeyOffset;
    return (cell >= 0 ? cell : cell - (kFineRatio - 1)) / kFineRatio;  // floor division
  };
  return voxel_key({part(42), part(21), part(0)});
}

// Merges fine voxels into the coarse ones they lie in; moments add up after a shift to the coarse centre.
std::vector<Voxel> merged(const std::vector<Voxel>& fine, double fine_voxel_m) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(fine.size());
  for (std::uint32_t i = 0; i < fine.size(); ++i) order[i] = {coarse_key(fine[i].key), i};
  std::sort(order.begin(), order.end());
  std::vector<Voxel> out;
  for (const auto& [key, i] : order) {
    if (out.empty() || out.back().key != key) out.emplace_back().key = key;
    const Voxel& f = fine[i];
    Voxel& v = out.back();
    const Eigen::Vector3d d = voxel_centre(f.key, fine_voxel_m) - voxel_centre(key, fine_voxel_m * kFineRatio);
    const double n = f.count;
    const auto shifted = [&](int a, int b) { return d[a] * f.sum[b] + d[b] * f.sum[a] + n * d[a] * d[b]; };
    v.squares += f.squares + (Eigen::Matrix<double, 6, 1>() << shifted(0, 0), shifted(0, 1), shifted(0, 2),
                              shifted(1, 1), shifted(1, 2), shifted(2, 2))
                                 .finished();
    v.sum += f.sum + n * d;
    v.count += f.count;
  }
  return out;
}

std::vector<Eigen::Vector3f> means_of(const std::vector<Voxel>& voxels, double voxel_m) {
  std::vector<Eigen::Vector3f> means(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    means[i] = (voxel_centre(voxels[i].key, voxel_m) + voxels[i].sum / voxels[i].count).cast<float>();
  return means;
}

std::vector<std::uint32_t> counts_of(const std::vector<Voxel>& voxels) {
  std::vector<std::uint32_t> counts;
  for (const Voxel& v : voxels) counts.push_back(v.count);
  return counts;
}

double clutter_density_of(const std::vector<Voxel>& voxels, double voxel_m) {
  const auto means = means_of(voxels, voxel_m);
  const auto counts = counts_of(voxels);
  return clutter_density({means, counts, static_cast<float>(voxel_m)});
}

// Takes out the voxels that chance alone would fill at this density of clutter; returns their keys.
std::unordered_set<std::uint64_t> take_out_clutter(std::vector<Voxel>& voxels, double voxel_m, double density) {
  std::unordered_set<std::uint64_t> keys;
  const auto means = means_of(voxels, voxel_m);
  const auto counts = counts_of(voxels);
  const auto clutter = find_clutter({means, counts, static_cast<float>(voxel_m)}, density);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (clutter[i]) keys.insert(voxels[i].key);
  std::erase_if(voxels, [&](const Voxel& v) { return keys.contains(v.key); });
  return keys;
}

// Nearest ranges by direction, of what remains when clutter is taken out.
FreeSpace image_of(const std::vector<Voxel>& fine, double fine_voxel_m, const Eigen::Vector3f& station) {
  FreeSpace image;
  image.size = kCubeSize;
  image.nearest_m.assign(6 * static_cast<std::size_t>(kCubeSize) * kCubeSize, std::numeric_limits<float>::infinity());
  const std::vector<Eigen::Vector3f> means = means_of(fine, fine_voxel_m);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const Eigen::Vector3f ray = means[i] - station;
    if (ray.isZero()) continue;
    float& nearest = image.nearest_m[cube_cell(ray, kCubeSize)];
    nearest = std::min(nearest, fine[i].min_range_m);
  }
  return image;
}

struct ThinnedVoxels {
  std::vector<Voxel> fine;  // sorted by key
  double noise_m = 0;
};

// The fine voxels with their points moved to the middle of the noise; nothing where noise is small against the coarse
// voxel. Of fifteen clean sets (woods among them) no scan had more than 0.26 voxels.
std::optional<ThinnedVoxels> without_noise(const std::vector<Voxel>& fine, const std::vector<Voxel>& coarse,
                                           double voxel_m) {
  constexpr double kMuchVoxels = 1.0 / 3, kLargestVoxels = 12;
  std::vector<Eigen::Vector3f> means;
  std::vector<Eigen::Matrix3f> covariances;
  for (const Voxel& v : coarse) {
    const VoxelMoments m = moments_of(v, voxel_m);
    means.push_back(m.mean), covariances.push_back(m.covariance);
  }
  const std::vector<std::uint32_t> counts = counts_of(coarse);
  const CountedPoints cloud{means, covariances, counts};
  ThinnedVoxels thin{{}, noise_m(cloud, voxel_m, kLargestVoxels * voxel_m)};
  if (thin.noise_m < kMuchVoxels * voxel_m) return std::nullopt;
  const double fine_voxel_m = voxel_m / kFineRatio;
  const std::vector<RidgePoint> ridge = thinned(means_of(fine, fine_voxel_m), cloud, thin.noise_m);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < fine.size(); ++i)
    order.emplace_back(voxel_key((ridge[i].point.cast<double>() / fine_voxel_m).array().floor().cast<std::int64_t>()),
                       i);
  std::sort(order.begin(), order.end());
  for (const auto& [key, i] : order) {
    if (thin.fine.empty() || thin.fine.back().key != key) thin.fine.emplace_back().key = key;
    Voxel& v = thin.fine.back();
    const double n = fine[i].count;
    const Eigen::Vector3d d = ridge[i].point.cast<double>() - voxel_centre(key, fine_voxel_m);
    const Eigen::Matrix3d in_plane =
        Eigen::Matrix3d::Identity() - ridge[i].normal.cast<double>() * ridge[i].normal.cast<double>().transpose();
    const Eigen::Matrix3d spread =
        in_plane * moments_of(fine[i], fine_voxel_m).covariance.cast<double>() * in_plane + d * d.transpose();
    v.sum += n * d;
    v.squares += n * (Eigen::Matrix<double, 6, 1>() << spread(0, 0), spread(0, 1), spread(0, 2), spread(1, 1),
                      spread(1, 2), spread(2, 2))
                         .finished();
    v.count += fine[i].count;
  }
  return thin;
}

// Points, normals and variation of the voxels that belong to a surface; returns the index of each kept voxel.
std::vector<std::uint32_t> fill(SurfacePoints& out, const std::vector<Voxel>& voxels, double voxel_m) {
  std::vector<VoxelMoments> moments(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) moments[i] = moments_of(voxels[i], voxel_m);
  const SurfaceEstimate surface = estimate_surface(moments, static_cast<float>(voxel_m));
  out.voxel_m = voxel_m;
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < voxels.size(); ++i) {
    if (surface.neighbours[i] < kMinVoxelNeighbours && surface.variation[i] >= 1.0f) continue;  // a stray point
    kept.push_back(i);
    out.points.push_back(moments[i].mean);
    out.normals.push_back(surface.normals[i]);
    out.variation.push_back(surface.variation[i]);
  }
  return kept;
}

// Twigs and leaves fill voxels that sight lines pass: what blocks nearly half of the lines at the voxel may let them
// through at half of it. There the station is believed only if from all six places around it more is hidden, and
// clearly more from five: a gap among the trunks lies anywhere.
double blocked_finely(const std::vector<Voxel>& fine, double fine_voxel_m, const Eigen::Vector3f& station,
                      const StationCheck& coarse) {
  constexpr float kAway = 0.2f;  // of the median range
  constexpr double kMuchLess = 0.9;
  SurfacePoints surface;
  fill(surface, fine, fine_voxel_m);
  const SightLines lines(surface.points, surface.normals, static_cast<float>(fine_voxel_m));
  constexpr int kPlaces = 6;
  const double here = lines.from(station).blocked;
  int clearly = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      const Eigen::Vector3f away =
          sign * kAway * static_cast<float>(coarse.median_range_m) * Eigen::Vector3f::Unit(axis);
      const double there = lines.from(station + away).blocked;
      if (here > there) return coarse.blocked;
      clearly += here <= kMuchLess * there;
    }
  return clearly >= kPlaces - 1 ? here : coarse.blocked;
}

std::uint32_t median_count(const std::vector<Voxel>& voxels) {
  if (voxels.empty()) return 0;
  std::vector<std::uint32_t> counts;
  for (const Voxel& v : voxels) counts.push_back(v.count);
  std::nth_element(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2), counts.end());
  return counts[counts.size() / 2];
}

}  // namespace

Result<SampledScan> VoxelSampler::finish() {
  State& s = *state_;
  if (s.finished) return fail("finish() was called twice");
  s.finished = true;
  SampledScan out;
  out.voxel_m = s.voxel_m;
  out.local_origin_in_scan = s.local_origin_in_scan;
  out.num_read = s.num_read;
  out.num_dropped = s.num_dropped;
  if (s.candidate_station && s.options.drop_no_return) {
    out.no_return_range_m = find_no_return_range(s.ranges, s.num_read);
    if (out.no_return_range_m) {
      const auto low = static_cast<float>(*out.no_return_range_m * (1 - 6 * kLogRangeStep));
      std::erase_if(s.voxels, [&](const Voxel& v) {
        if (v.min_range_m < low) return false;
        out.num_dropped += v.count;
        return true;
      });
      for (float& nearest : s.raw.nearest_m)
        if (nearest >= low) nearest = std::numeric_limits<float>::infinity();
      out.notes.push_back(fmt::format("dropped a shell of no-return points at {:.4g} m", *out.no_return_range_m));
    }
  }
  std::sort(s.voxels.begin(), s.voxels.end(), [](const Voxel& a, const Voxel& b) { return a.key < b.key; });
  {
    std::vector<Voxel> coarse = merged(s.voxels, s.fine_voxel_m);
    const double density = clutter_density_of(coarse, s.voxel_m);
    if (density > 0) {
      const std::size_t before = coarse.size();
      const auto keys = take_out_clutter(coarse, s.voxel_m, density);
      for (const Voxel& v : s.voxels)
        if (keys.contains(coarse_key(v.key))) out.num_dropped += v.count;
      std::erase_if(s.voxels, [&](const Voxel& v) { return keys.contains(coarse_key(v.key)); });
      if (s.candidate_station) s.raw = image_of(s.voxels, s.fine_voxel_m, *s.candidate_station);
      out.notes.push_back(fmt::format("{:.0f} % of the voxels float evenly in the air and were left out",
                                      100.0 * static_cast<double>(keys.size()) / static_cast<double>(before)));
    }
    if (auto thin = without_noise(s.voxels, coarse, s.voxel_m)) {
      s.voxels = std::move(thin->fine);
      coarse = merged(s.voxels, s.fine_voxel_m);
      out.notes.push_back(fmt::format("noise of {:.2g} m: surfaces were thinned to the middle of it", thin->noise_m));
    }
    if (density > 0) {  // the coarse level is made: what goes now is missing at the fine one only
      constexpr double kFineVoxels = kFineRatio * kFineRatio * kFineRatio;
      take_out_clutter(s.voxels, s.fine_voxel_m, density / kFineVoxels);
    }
    SurfacePoints surface;
    const std::vector<std::uint32_t> kept = fill(surface, coarse, s.voxel_m);
    for (const Voxel& v : coarse) out.num_dropped += v.count;
    for (const std::uint32_t i : kept) out.counts.push_back(coarse[i].count), out.num_dropped -= coarse[i].count;
    out.points = std::move(surface.points);
    out.normals = std::move(surface.normals);
    out.variation = std::move(surface.variation);
    out.spacing_m = s.voxel_m / std::sqrt(std::max(1.0, static_cast<double>(median_count(coarse))));
  }
  constexpr std::size_t kMinVoxels = 10;
  if (out.points.size() < kMinVoxels)
    return fail(fmt::format("only {} voxels of {:.4g} m hold a surface, {} of {} points are usable", out.points.size(),
                            s.voxel_m, s.num_read - out.num_dropped, s.num_read),
                "", "check the file's content and unit, or set sampling.voxel_m");
  if (median_count(s.voxels) >= kMinFineCount) fill(out.fine, s.voxels, s.fine_voxel_m);
  // No scanner stands at the mean of what it sees to a ten-thousandth: such a cloud was centred by a program.
  constexpr double kCentred = 1e-4;
  const auto num_rays = static_cast<double>(s.num_read);
  const bool centred =
      s.candidate_station && !s.station_from_file && s.ray_sum.norm() < kCentred * std::sqrt(s.sq_range_sum * num_rays);
  StationCheck check;
  if (s.candidate_station) {
    check = SightLines(out.points, out.normals, static_cast<float>(s.voxel_m)).from(*s.candidate_station);
    if (check.blocked >= kMaxBlocked)
      check.blocked = blocked_finely(s.voxels, s.fine_voxel_m, *s.candidate_station, check);
  }
  const bool object = check.median_range_m < kObjectRangeM && check.concentration > kObjectConcentration;
  const bool plausible = check.blocked < kMaxBlocked && !object && check.concentration < kMaxConcentration;
  const bool believed = s.candidate_station && (s.options.station == "origin" || (plausible && !centred));
  if (believed) {
    out.station_kind = StationKind::origin;
    out.station = *s.candidate_station;
    out.blocked_share = check.blocked;
    orient_to_station(out.points, out.station, out.normals);
    orient_to_station(out.fine.points, out.station, out.fine.normals);
    out.free_space = dilated_free_space(at_scan_resolution(s.raw));
  } else if (plausible && s.candidate_station) {
    // Not where the scanner stood, but in its midst: good enough to tell the sides of surfaces, and what was seen
    // through where it does not depend on some metres.
    out.station_kind = StationKind::estimated;
    out.station = *s.candidate_station;
    constexpr double kSigmaOfMedianRange = 0.03;
    out.station_sigma_m = kSigmaOfMedianRange * check.median_range_m;
    out.blocked_share = check.blocked;
    orient_to_station(out.points, *s.candidate_station, out.normals);
    orient_to_station(out.fine.points, *s.candidate_station, out.fine.normals);
    out.free_space = dilated_free_space(
        at_least_cells_of(at_scan_resolution(s.raw), out.station_sigma_m / std::max(check.median_range_m, 1e-9)));
    out.notes.push_back(fmt::format(
        "the cloud is centred on its mean: its station is taken to be there within {:.2g} m", out.station_sigma_m));
  } else {
    orient_outwards(out.points, static_cast<float>(s.voxel_m), out.normals);
    orient_like(out.points, out.normals, static_cast<float>(s.voxel_m), out.fine.points, out.fine.normals);
    out.notes.push_back(s.candidate_station
                            ? fmt::format("the {} is not the station ({:.0f} % of the sight lines blocked, "
                                          "concentration {:.2f}): free space is not used",
                                          s.station_from_file ? "place that is stated" : "origin", 100 * check.blocked,
                                          check.concentration)
                            : std::string("station unknown: free space is not used") +
                                  (s.options.station == "unknown" ? "" : " (sampling.stations can name it)"));
  }
  return out;
}

}  // namespace isthmus
