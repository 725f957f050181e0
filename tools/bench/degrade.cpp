#include "bench/degrade.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace isthmus::bench {

std::string suffix_of(const Degradation& d) {
  std::string text;
  if (d.noise_voxels != 0) text += fmt::format("-noise{:g}", d.noise_voxels);
  if (d.outliers != 0) text += fmt::format("-outliers{:g}", d.outliers);
  if (d.density != 1) text += fmt::format("-density{:g}", d.density);
  return text;
}

evaluate::Points degraded(const evaluate::Points& points, const Degradation& d, bool thinned, double voxel_m, Rng rng) {
  evaluate::Points out;
  const double kept = thinned ? d.density : 1;
  for (const auto& p : points)
    if (kept == 1 || rng.uniform() < kept) out.push_back(p);
  if (d.noise_voxels > 0)
    for (auto& p : out)
      for (int a = 0; a < 3; ++a) p[a] += d.noise_voxels * voxel_m * rng.normal();
  if (d.outliers <= 0 || out.empty()) return out;
  Eigen::AlignedBox3d box;
  for (const auto& p : out) box.extend(p);
  const auto added =
      static_cast<std::size_t>(std::round(d.outliers / (1 - d.outliers) * static_cast<double>(out.size())));
  for (std::size_t k = 0; k < added; ++k) {
    Eigen::Vector3d p;
    for (int a = 0; a < 3; ++a) p[a] = rng.uniform(box.min()[a], box.max()[a]);
    out.push_back(p);
    std::swap(out.back(), out[rng.below(out.size())]);
  }
  return out;
}

}  // namespace isthmus::bench
