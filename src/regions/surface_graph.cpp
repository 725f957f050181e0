#include "regions/surface_graph.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {

SurfaceGraph::SurfaceGraph(const SampledScan& scan, float reach_m) : begin_(scan.points.size() + 1, 0) {
  const auto has_normal = [&](std::size_t i) { return scan.variation[i] < 1.0f; };
  const PointGrid grid(scan.points, reach_m);
  std::vector<std::vector<std::uint32_t>> lists(scan.points.size());
  parallel_for_index(scan.points.size(), 128, [&](std::size_t i) {
    if (!has_normal(i)) return;
    grid.for_each_within(scan.points[i], reach_m, [&](std::uint32_t j, float) {
      if (j != i && has_normal(j)) lists[i].push_back(j);
    });
    std::ranges::sort(lists[i]);
  });
  for (std::size_t i = 0; i < lists.size(); ++i) {
    neighbours_.insert(neighbours_.end(), lists[i].begin(), lists[i].end());
    begin_[i + 1] = neighbours_.size();
  }
}

}  // namespace isthmus
