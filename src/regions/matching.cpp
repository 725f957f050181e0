#include "regions/matching.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <functional>

#include "base/parallel.h"

namespace isthmus {
namespace {

// One number for a similarity and whose it is, so that selecting compares integers: the greater is the more similar,
// of equals the one with the smaller index. Not for NaN.
std::uint64_t key_of(float similarity, std::uint32_t index) {
  const auto bits = std::bit_cast<std::uint32_t>(similarity + 0.0f);  // one zero
  const std::uint32_t ordered = bits >> 31 ? ~bits : bits | 0x80000000u;
  return std::uint64_t{ordered} << 32 | ~index;
}
std::uint32_t index_of(std::uint64_t key) { return ~static_cast<std::uint32_t>(key); }

}  // namespace

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
    std::vector<std::uint64_t> keys(m);
    for (std::size_t r = 0; r < rows; ++r) {
      const float* s = similarity.data() + r * m;
      for (std::uint32_t j = 0; j < m; ++j) keys[j] = key_of(s[j], j);
      std::nth_element(keys.begin(), keys.begin() + (table.count - 1), keys.end(), std::greater<>());
      std::sort(keys.begin(), keys.begin() + table.count, std::greater<>());
      for (std::uint32_t k = 0; k < table.count; ++k) {
        const std::uint32_t j = index_of(keys[k]);
        table.target[(first + r) * table.count + k] = j;
        table.similarity[(first + r) * table.count + k] = s[j];
      }
    }
  });
  return table;
}

}  // namespace isthmus
