#include "survey/spanning_forest.h"

#include <algorithm>
#include <queue>

namespace isthmus::survey {
namespace {

using Adjacency = std::vector<std::vector<int>>;  // per node, incident measurements, ascending

int other_end(const Measurement& m, int node) { return m.source == node ? m.target : m.source; }

template <class Edges>
Adjacency adjacency_of(int num_nodes, std::span<const Measurement> measurements, const Edges& edges) {
  Adjacency adjacency(static_cast<std::size_t>(num_nodes));
  for (const int e : edges) {
    adjacency[measurements[e].source].push_back(e);
    adjacency[measurements[e].target].push_back(e);
  }
  return adjacency;
}

}  // namespace

int DisjointSets::find(int i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

bool DisjointSets::join(int a, int b) {
  a = find(a), b = find(b);
  if (a == b) return false;
  parent_[std::max(a, b)] = std::min(a, b);
  return true;
}

Relative walked_from(const Measurement& measurement, int from) {
  return from == measurement.source ? measurement.target_from_source : inverse(measurement.target_from_source);
}

SpanningForest forest_of(int num_nodes, std::span<const Measurement> measurements, const std::vector<int>& edges) {
  const auto n = static_cast<std::size_t>(num_nodes);
  SpanningForest forest{std::vector<int>(n, -1), std::vector<int>(n, -1), std::vector<int>(n, -1),
                        std::vector<int>(n, 0), std::vector<Transform>(n, Transform::Identity())};
  const Adjacency adjacency = adjacency_of(num_nodes, measurements, edges);
  for (int start = 0; start < num_nodes; ++start) {
    if (forest.root[start] >= 0) continue;
    forest.root[start] = start;
    std::queue<int> open({start});
    for (; !open.empty(); open.pop()) {
      const int node = open.front();
      for (const int e : adjacency[node]) {
        const int next = other_end(measurements[e], node);
        if (forest.root[next] >= 0) continue;
        forest.root[next] = start;
        forest.parent[next] = node;
        forest.parent_edge[next] = e;
        forest.depth[next] = forest.depth[node] + 1;
        forest.root_from_node[next] = forest.root_from_node[node] * walked_from(measurements[e], next).b_from_a;
        open.push(next);
      }
    }
  }
  return forest;
}

std::vector<int> spanning_edges(int num_nodes, std::span<const Measurement> measurements,
                                const std::vector<int>& order) {
  DisjointSets sets(num_nodes);
  std::vector<int> edges;
  for (const int e : order)
    if (sets.join(measurements[e].source, measurements[e].target)) edges.push_back(e);
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::vector<int> tree_path(const SpanningForest& forest, int a, int b) {
  std::vector<int> up, down;
  while (a != b) {
    if (forest.depth[a] >= forest.depth[b]) {
      up.push_back(forest.parent_edge[a]);
      a = forest.parent[a];
    } else {
      down.push_back(forest.parent_edge[b]);
      b = forest.parent[b];
    }
  }
  up.insert(up.end(), down.rbegin(), down.rend());
  return up;
}

Relative along(std::span<const Measurement> measurements, const std::vector<int>& path, int a) {
  Relative b_from_a;
  for (const int e : path) {
    b_from_a = compose(walked_from(measurements[e], a), b_from_a);
    a = other_end(measurements[e], a);
  }
  return b_from_a;
}

std::vector<int> shortest_path(int num_nodes, std::span<const Measurement> measurements,
                               const std::vector<char>& usable, int a, int b) {
  std::vector<int> usable_edges;
  for (int e = 0; e < static_cast<int>(measurements.size()); ++e)
    if (usable[e]) usable_edges.push_back(e);
  const Adjacency adjacency = adjacency_of(num_nodes, measurements, usable_edges);
  std::vector<int> came_by(static_cast<std::size_t>(num_nodes), -1);
  std::vector<char> seen(static_cast<std::size_t>(num_nodes), 0);
  seen[a] = 1;
  std::queue<int> open({a});
  for (; !open.empty() && !seen[b]; open.pop())
    for (const int e : adjacency[open.front()]) {
      const int next = other_end(measurements[e], open.front());
      if (seen[next]) continue;
      seen[next] = 1;
      came_by[next] = e;
      open.push(next);
    }
  std::vector<int> path;
  if (!seen[b]) return path;
  for (int node = b; node != a; node = other_end(measurements[path.back()], node)) path.push_back(came_by[node]);
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<int> nodes_of_path(std::span<const Measurement> measurements, const std::vector<int>& path, int a) {
  std::vector<int> nodes{a};
  for (const int e : path) nodes.push_back(other_end(measurements[e], nodes.back()));
  return nodes;
}

}  // namespace isthmus::survey
