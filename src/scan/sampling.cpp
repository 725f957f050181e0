#include "scan/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

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

std::size_t occupied(const std::vector<Eigen::Vector3f>& points, double voxel_m) {
  std::unordered_set<std::uint64_t> cells;
  cells.reserve(points.size());
  for (const auto& p : points) {
    const Eigen::Matrix<std::int64_t, 3, 1> c = (p.cast<double>() / voxel_m).array().floor().cast<std::int64_t>();
    cells.insert(static_cast<std::uint64_t>(c[0] & 0x1fffff) << 42 | static_cast<std::uint64_t>(c[1] & 0x1fffff) << 21 |
                 static_cast<std::uint64_t>(c[2] & 0x1fffff));
  }
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

}  // namespace

Result<ScanScale> scale_of_probe(const PointChunk& probe, std::optional<std::uint64_t> num_points, int target_points) {
  constexpr std::size_t kMinPoints = 20;
  // A voxel should gather more than one raw point, or sampling keeps the scanner's pattern: at most this share of the
  // raw points may remain.
  constexpr double kMaxShareKept = 0.55;
  // Surfaces of N voxels reach over sqrt(N) / 2 to 2 sqrt(N) of them. Foliage fills space: there 15,000 reached over
  // 37, voxels of more than a metre, in which trunks are lost. Half of that finds them.
  const double least_across = 0.5 * std::sqrt(static_cast<double>(target_points));
  constexpr double kShrinking = 1.5;
  std::vector<Eigen::Vector3f> points;
  for (const auto& p : probe.points)
    if (p.allFinite() && !p.isZero()) points.push_back(p);
  if (points.size() < kMinPoints)
    return fail("only " + std::to_string(points.size()) + " usable points", "",
                "the scan is empty or holds no coordinates");
  ScanScale scale;
  scale.extent_m = robust_extent(points);
  if (!(scale.extent_m > 0)) return fail("all points are the same", "", "check the file's coordinate columns");
  // Number of occupied voxels falls as the voxel grows: bisect its logarithm.
  const auto voxel_for = [&](double wanted) {
    double low = std::log(scale.extent_m * 1e-5), high = std::log(scale.extent_m * 2);
    for (int step = 0; step < 16; ++step) {
      const double middle = 0.5 * (low + high);
      (static_cast<double>(occupied(points, std::exp(middle))) > wanted ? low : high) = middle;
    }
    return std::exp(high);
  };
  const auto probed = static_cast<double>(points.size());
  scale.voxel_m = voxel_for(std::min(static_cast<double>(target_points), 0.3 * probed));
  if (static_cast<double>(target_points) > 0.3 * probed)  // surfaces: the number of voxels goes with the inverse square
    scale.voxel_m *= std::sqrt(0.3 * probed / target_points);
  const double across = scale.extent_m / scale.voxel_m;
  if (across < least_across) scale.voxel_m *= std::pow(across / least_across, kShrinking);
  const bool whole = !num_points || static_cast<double>(*num_points) < 1.5 * probed;
  scale.spacing_m = whole ? voxel_for(kMaxShareKept * probed) : 0;
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
