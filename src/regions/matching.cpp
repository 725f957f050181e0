#include "regions/matching.h"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "base/parallel.h"

namespace isthmus {

MatchTable match_descriptors(const FeatureCloud& source, const FeatureCloud& target, std::uint32_t count) {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr std::size_t kBlock = 64;  // source rows a task: the block of similarities stays in cache
  MatchTable table;
  const std::size_t n = source.keypoints.size(), m = target.keypoints.size();
  table.count = static_cast<std::uint32_t>(std::min<std::size_t>(count, m));
  table.target.resize(n * table.count);
  table.similarity.resize(n * table.count);
  if (n == 0 || table.count == 0) return table;
  const Eigen::Map<const Rows> a(source.descriptors.data(), static_cast<Eigen::Index>(n), source.dimension);
  const Eigen::Map<const Rows> b(target.descriptors.data(), static_cast<Eigen::Index>(m), target.dimension);
  parallel_for_index((n + kBlock - 1) / kBlock, 1, [&](std::size_t block) {
    const std::size_t first = block * kBlock, rows = std::min(kBlock, n - first);
    const Rows similarity =
        a.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(rows)) * b.transpose();
    std::vector<std::uint32_t> order(m);
    for (std::size_t r = 0; r < rows; ++r) {
      const float* s = similarity.data() + r * m;
      std::iota(order.begin(), order.end(), 0u);
      const auto better = [s](std::uint32_t i, std::uint32_t j) { return s[i] != s[j] ? s[i] > s[j] : i < j; };
      std::nth_element(order.begin(), order.begin() + (table.count - 1), order.end(), better);
      std::sort(order.begin(), order.begin() + table.count, better);
      for (std::uint32_t k = 0; k < table.count; ++k) {
        table.target[(first + r) * table.count + k] = order[k];
        table.similarity[(first + r) * table.count + k] = s[order[k]];
      }
    }
  });
  return table;
}

}  // namespace isthmus
