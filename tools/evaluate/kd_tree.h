// Exact k nearest neighbours in double precision: what an evaluator must not approximate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace isthmus::evaluate {

struct Neighbour {
  std::uint32_t index = 0;
  double sq_distance = 0;
};

/// Static kd-tree (median splits, 12 points a leaf). Keeps a reference to the points. Ties go to the smaller index.
class KdTree {
 public:
  explicit KdTree(std::span<const Eigen::Vector3d> points);

  /// Up to k nearest points strictly nearer than max_distance, nearest first; replaces `out`.
  void nearest(const Eigen::Vector3d& query, std::size_t k, double max_distance, std::vector<Neighbour>& out) const;

 private:
  struct Node {
    std::uint32_t begin = 0, end = 0;
    std::int32_t left = -1, right = -1;  // -1: leaf
    int axis = 0;
    double split = 0;
  };
  std::int32_t build(std::uint32_t begin, std::uint32_t end);
  void search(std::int32_t node, const Eigen::Vector3d& query, std::size_t k, double sq_max,
              std::vector<Neighbour>& out) const;

  std::span<const Eigen::Vector3d> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace isthmus::evaluate
