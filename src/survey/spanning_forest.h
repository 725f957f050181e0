// Trees of links: initial poses, paths, loops.
#pragma once

#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "survey/link_model.h"

namespace isthmus::survey {

/// Disjoint sets over 0..n-1; the root of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(int n) : parent_(static_cast<std::size_t>(n)) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i);
  bool join(int a, int b);  ///< false if they were one set already

 private:
  std::vector<int> parent_;
};

/// One tree per part; a part's root is its smallest node.
struct SpanningForest {
  std::vector<int> root;         ///< per node
  std::vector<int> parent;       ///< per node, -1 at roots
  std::vector<int> parent_edge;  ///< per node, measurement that leads to the parent, -1 at roots
  std::vector<int> depth;
  std::vector<Transform> root_from_node;
};

/// The forest that the measurements `edges` span; they must hold no cycle.
SpanningForest forest_of(int num_nodes, std::span<const Measurement> measurements, const std::vector<int>& edges);

/// Maximum spanning forest (Kruskal 1956): takes `order` (best first) and keeps what joins two parts. Returns ascending
/// indices.
std::vector<int> spanning_edges(int num_nodes, std::span<const Measurement> measurements,
                                const std::vector<int>& order);

/// The measurement walked from node `from`: other_from_`from`.
Relative walked_from(const Measurement& measurement, int from);

/// Measurements of the tree path from a to b, in walking order. Precondition: one part.
std::vector<int> tree_path(const SpanningForest& forest, int a, int b);

/// b_from_a along the measurements of a path that starts at node a.
Relative along(std::span<const Measurement> measurements, const std::vector<int>& path, int a);

/// Fewest measurements from a to b among those marked usable (breadth first, smallest index first); empty if there are
/// none.
std::vector<int> shortest_path(int num_nodes, std::span<const Measurement> measurements,
                               const std::vector<char>& usable, int a, int b);

/// Nodes of a path that starts at node a.
std::vector<int> nodes_of_path(std::span<const Measurement> measurements, const std::vector<int>& path, int a);

}  // namespace isthmus::survey
