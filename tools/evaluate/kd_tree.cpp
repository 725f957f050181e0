#include "evaluate/kd_tree.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace isthmus::evaluate {
namespace {

constexpr std::uint32_t kLeafSize = 12;

bool nearer(const Neighbour& a, const Neighbour& b) {
  return std::tie(a.sq_distance, a.index) < std::tie(b.sq_distance, b.index);
}

}  // namespace

KdTree::KdTree(std::span<const Eigen::Vector3d> points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!points.empty()) build(0, static_cast<std::uint32_t>(points.size()));
}

std::int32_t KdTree::build(std::uint32_t begin, std::uint32_t end) {
  const auto id = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({begin, end, -1, -1, 0, 0});
  if (end - begin <= kLeafSize) return id;
  Eigen::Vector3d low = points_[order_[begin]], high = low;
  for (std::uint32_t k = begin; k < end; ++k)
    low = low.cwiseMin(points_[order_[k]]), high = high.cwiseMax(points_[order_[k]]);
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
  const double split = points_[order_[middle]][axis];
  const std::int32_t left = build(begin, middle), right = build(middle, end);
  Node& node = nodes_[id];
  node.left = left, node.right = right, node.axis = axis, node.split = split;
  return id;
}

void KdTree::nearest(const Eigen::Vector3d& query, std::size_t k, double max_distance,
                     std::vector<Neighbour>& out) const {
  out.clear();
  if (nodes_.empty() || k == 0) return;
  search(0, query, k, max_distance * max_distance, out);
  std::sort(out.begin(), out.end(), nearer);
}

void KdTree::search(std::int32_t id, const Eigen::Vector3d& query, std::size_t k, double sq_max,
                    std::vector<Neighbour>& out) const {
  const Node& node = nodes_[id];
  if (node.left < 0) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Neighbour candidate{order_[i], (points_[order_[i]] - query).squaredNorm()};
      if (candidate.sq_distance >= sq_max) continue;
      if (out.size() == k) {
        if (!nearer(candidate, out.front())) continue;
        std::pop_heap(out.begin(), out.end(), nearer);
        out.pop_back();
      }
      out.push_back(candidate);
      std::push_heap(out.begin(), out.end(), nearer);
    }
    return;
  }
  const double off = query[node.axis] - node.split;
  search(off < 0 ? node.left : node.right, query, k, sq_max, out);
  const double limit = out.size() < k ? sq_max : std::min(sq_max, out.front().sq_distance);
  if (off * off <= limit) search(off < 0 ? node.right : node.left, query, k, sq_max, out);
}

}  // namespace isthmus::evaluate
