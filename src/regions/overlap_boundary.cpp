#include "regions/overlap_boundary.h"

#include "geometry/point_grid.h"

namespace isthmus {

std::vector<std::uint8_t> at_overlap_boundary(std::span<const Eigen::Vector3f> points,
                                              std::span<const std::uint8_t> inside,
                                              std::span<const std::uint32_t> sample, float reach_m) {
  constexpr std::size_t kOneOutsideIn =
      4;  // at a straight boundary one in two is outside, at an outer corner three in four
  const PointGrid grid(points, reach_m);
  std::vector<std::uint8_t> marks;
  for (const std::uint32_t i : sample) {
    std::size_t all = 0, outside = 0;
    grid.for_each_within(points[i], reach_m, [&](std::uint32_t j, float) {
      if (j != i) ++all, outside += inside[j] == 0;
    });
    marks.push_back(outside > 0 && kOneOutsideIn * outside >= all);
  }
  return marks;
}

}  // namespace isthmus
