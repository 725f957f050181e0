#include "scan/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "geometry/point_grid.h"
#include "scan/clutter.h"
#include "scan/thinning.h"

namespace isthmus {

const config::OptionTable<SamplingOptions>& sampling_options_table() {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  static const config::OptionTable<SamplingOptions> table{
      "sampling",
      "Reduction of each scan to one point a voxel, with a normal.",
      {
          {"voxel_m",
           &SamplingOptions::voxel_m,
           "m",
           1e-6,
           1e3,
           {},
           "Edge of the sampling voxels, one value for all scans. Automatic: from a probe of every scan, so that a "
           "scan keeps "
           "about target_points points.",
           "docs/stages/sampling.md"},
          {"target_points",
           &SamplingOptions::target_points,
           "",
           500,
           10000000,
           {},
           "Voxel points that a typical scan should keep when voxel_m is automatic. More points see smaller things and "
           "cost "
           "more time.",
           "docs/stages/sampling.md"},
          {"drop_no_return",
           &SamplingOptions::drop_no_return,
           "",
           0,
           1,
           {},
           "Drop a shell of points at one constant largest range, as some scanners write for beams that never came "
           "back.",
           "SICK LMS scans of 3DTK: 1.8 % of the points at 32.77 m"},
          {"station",
           &SamplingOptions::station,
           "",
           0,
           0,
           {"auto", "origin", "unknown"},
           "Where the scanner stood. auto: the origin (or the file's own word) if the sight lines from there are free; "
           "origin: "
           "believe it unchecked; unknown: use no free space.",
           "docs/stages/sampling.md"},
          // Which station a scan is given enters the keys of its own products: a new line costs one scan, not all.
          {"stations",
           &SamplingOptions::stations,
           "",
           -kInf,
           kInf,
           {},
           "CSV file of where the scanner stood, columns scan,x,y,z in metres, in the coordinates of each scan's own "
           "file: for LAS, "
           "PLY and text in map coordinates, which have no place for it. Taken before the file's own word, checked "
           "like "
           "it.",
           "docs/stages/sampling.md",
           false},
      }};
  return table;
}

namespace {

constexpr std::size_t kMinProbed = 20;

std::uint64_t cell_key(const Eigen::Vector3f& p, double voxel_m) {
  const Eigen::Matrix<std::int64_t, 3, 1> c = (p.cast<double>() / voxel_m).array().floor().cast<std::int64_t>();
  return static_cast<std::uint64_t>(c[0] & 0x1fffff) << 42 | static_cast<std::uint64_t>(c[1] & 0x1fffff) << 21 |
         static_cast<std::uint64_t>(c[2] & 0x1fffff);
}

std::size_t occupied(const std::vector<Eigen::Vector3f>& points, double voxel_m) {
  std::unordered_set<std::uint64_t> cells;
  cells.reserve(points.size());
  for (const auto& p : points) cells.insert(cell_key(p, voxel_m));
  return cells.size();
}

double robust_extent(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d size;
  std::vector<float> values(points.size());
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
    std::sort(values.begin(), values.end());
    size[a] =
        static_cast<double>(values[values.size() * 95 / 100]) - static_cast<double>(values[values.size() * 5 / 100]);
  }
  return size.norm();
}

void erase_far(std::vector<Eigen::Vector3f>& points, double farthest_m) {
  Eigen::Vector3d middle;
  std::vector<float> values(points.size());
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][a];
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    middle[a] = static_cast<double>(*at);
  }
  std::erase_if(points, [&](const Eigen::Vector3f& p) { return !((p.cast<double>() - middle).norm() <= farthest_m); });
}

struct ProbedSurface {
  std::vector<Eigen::Vector3f> points;
  double extent_m = 0;

  // Number of occupied voxels falls as the voxel grows: bisect its logarithm.
  [[nodiscard]] double voxel_for(double wanted) const {
    double low = std::log(extent_m * 1e-5), high = std::log(extent_m * 2);
    for (int step = 0; step < 16; ++step) {
      const double middle = 0.5 * (low + high);
      (static_cast<double>(occupied(points, std::exp(middle))) > wanted ? low : high) = middle;
    }
    return std::exp(high);
  }

  [[nodiscard]] double voxel_for_target(int target_points) const {
    // Surfaces of N voxels reach over sqrt(N) / 2 to 2 sqrt(N) of them. Foliage fills space: there 15,000 reached over
    // 37, voxels of more than a metre, in which trunks are lost. Half of that finds them.
    const double least_across = 0.5 * std::sqrt(static_cast<double>(target_points));
    constexpr double kShrinking = 1.5;
    const double enough = 0.3 * static_cast<double>(points.size());
    double voxel_m = voxel_for(std::min(static_cast<double>(target_points), enough));
    if (static_cast<double>(target_points) > enough)  // surfaces: the number of voxels goes with the inverse square
      voxel_m *= std::sqrt(enough / target_points);
    const double across = extent_m / voxel_m;
    if (across < least_across) voxel_m *= std::pow(across / least_across, kShrinking);
    return voxel_m;
  }
};

struct Occupied {
  std::vector<Eigen::Vector3f> means;
  std::vector<std::uint32_t> counts;
  std::vector<std::uint32_t> voxel_of_point;
};

// Voxels in the order of their first points.
Occupied occupied_voxels(const std::vector<Eigen::Vector3f>& points, double voxel_m) {
  Occupied out;
  std::unordered_map<std::uint64_t, std::uint32_t> voxels;
  voxels.reserve(points.size());
  for (const auto& p : points) {
    const auto [at, is_new] = voxels.try_emplace(cell_key(p, voxel_m), static_cast<std::uint32_t>(out.means.size()));
    if (is_new) out.means.emplace_back(Eigen::Vector3f::Zero()), out.counts.push_back(0);
    out.means[at->second] += p;
    ++out.counts[at->second];
    out.voxel_of_point.push_back(at->second);
  }
  for (std::size_t i = 0; i < out.means.size(); ++i) out.means[i] /= static_cast<float>(out.counts[i]);
  return out;
}

// The probe without what floats in the air, told at this voxel or, where a room holds too few blocks of it, at finer
// ones; empty if nothing floats there.
std::vector<Eigen::Vector3f> without_clutter_at(const std::vector<Eigen::Vector3f>& points, double voxel_m) {
  constexpr double kFinest = 0.2;
  constexpr std::size_t kMinPointsAVoxel = 2;  // below it surfaces look like scattered points themselves
  std::vector<Eigen::Vector3f> left;
  for (double edge_m = voxel_m; left.empty() && edge_m > kFinest * voxel_m; edge_m /= 2) {
    const Occupied voxels = occupied_voxels(points, edge_m);
    if (points.size() < kMinPointsAVoxel * voxels.means.size()) break;
    const OccupiedVoxels cells{voxels.means, voxels.counts, static_cast<float>(edge_m)};
    const double density = clutter_density(cells);
    if (density == 0) continue;
    const std::vector<std::uint8_t> clutter = find_clutter(cells, density);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!clutter[voxels.voxel_of_point[i]]) left.push_back(points[i]);
  }
  return left;
}

double noise_of(const ProbedSurface& surface, double voxel_m) {
  constexpr double kMaxShareOfExtent = 0.2, kMaxVoxels = 40;
  const std::vector<std::uint32_t> ones(surface.points.size(), 1);
  return noise_m({surface.points, {}, ones}, voxel_m,
                 std::min(kMaxShareOfExtent * surface.extent_m, kMaxVoxels * voxel_m));
}

}  // namespace

Result<ScanScale> scale_of_probe(const PointChunk& probe, std::optional<std::uint64_t> num_points, int target_points) {
  // A voxel should gather more than one raw point, or sampling keeps the scanner's pattern: at most this share of the
  // raw points may remain.
  constexpr double kMaxShareKept = 0.55;
  constexpr int kRounds = 3;
  constexpr double kFarthest = 1e4;  // extents from the middle: marks of missing data, not places
  std::vector<Eigen::Vector3f> points;
  for (const auto& p : probe.points)
    if (p.allFinite() && !p.isZero()) points.push_back(p);
  if (points.size() < kMinProbed)
    return fail("only " + std::to_string(points.size()) + " usable points", "",
                "the scan is empty or holds no coordinates");
  const bool whole = !num_points || static_cast<double>(*num_points) < 1.5 * static_cast<double>(points.size());
  if (const double extent_m = robust_extent(points); extent_m > 0) erase_far(points, kFarthest * extent_m);
  ProbedSurface probed{points, robust_extent(points)};
  if (!(probed.extent_m > 0)) return fail("all points are the same", "", "check the file's coordinate columns");
  ScanScale scale;
  scale.voxel_m = probed.voxel_for_target(target_points);
  // A wall's thousand points fill few voxels, a thousand that float in the air fill a thousand: the voxel would grow
  // until they share some. What floats is left out at the voxel that all points give, which is too large, and again at
  // the one that is left then.
  for (int round = 0; round < kRounds; ++round) {
    ProbedSurface left{without_clutter_at(points, scale.voxel_m)};
    if (left.points.size() >= kMinProbed) left.extent_m = robust_extent(left.points);
    if (!(left.extent_m > 0)) break;
    probed = std::move(left);
    scale.voxel_m = probed.voxel_for_target(target_points);
  }
  scale.extent_m = probed.extent_m;
  constexpr double kDeviations = 1.5;  // thinned surfaces are no thicker; a finer voxel would gain nothing
  scale.voxel_m = std::max(scale.voxel_m, kDeviations * noise_of(probed, scale.voxel_m));
  scale.spacing_m = whole ? probed.voxel_for(kMaxShareKept * static_cast<double>(probed.points.size())) : 0;
  return scale;
}

double automatic_voxel_m(std::span<const ScanScale> scales) {
  std::vector<double> voxels, floors;
  for (const auto& s : scales) voxels.push_back(s.voxel_m), floors.push_back(s.spacing_m);
  const auto middle = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  const double wanted = std::max(middle(voxels), middle(floors));
  constexpr double kStepsPerDecade = 10;  // Renard series R10: 1, 1.26, 1.58, 2, ...
  const double exponent = std::round(std::log10(wanted) * kStepsPerDecade) / kStepsPerDecade;
  return std::pow(10.0, exponent);
}

}  // namespace isthmus
