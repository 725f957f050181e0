// Sparse weighted graphs and the vector that says where they hang together least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace isthmus {

/// Undirected; no loops.
class WeightedGraph {
 public:
  struct Tie {
    std::uint32_t a, b;
    double weight;  ///< >= 0
  };
  /// A tie that is given twice, in either direction, counts once, with the greater weight.
  WeightedGraph(std::size_t num_nodes, std::span<const Tie> ties);

  [[nodiscard]] std::size_t size() const { return degree_.size(); }
  [[nodiscard]] double degree(std::size_t i) const { return degree_[i]; }  ///< sum of the weights of its ties
  /// (node, weight) of all ties of `i`, nodes ascending.
  [[nodiscard]] std::span<const std::pair<std::uint32_t, double>> around(std::size_t i) const {
    return std::span(ties_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }
  /// Nodes that hang together, each part ascending, parts by their first nodes.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> components() const;
  /// The graph among `nodes` (distinct), numbered as they stand there.
  [[nodiscard]] WeightedGraph part(std::span<const std::uint32_t> nodes) const;

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::pair<std::uint32_t, double>> ties_;
  std::vector<double> degree_;
};

/// A position on a line for every node, tied nodes close together: the generalised eigenvector of (D - W) y = l D y
/// with the second smallest l (Fiedler 1973; Shi, Malik 2000, section 2.1), by Lanczos' method with a fixed number of
/// steps (Lanczos 1950; Saad 2011, chapter 6) on (I + D^-1/2 W D^-1/2) / 2. Its sign and scale are arbitrary. Large
/// graphs get an approximation: enough for a cut, not for a spectrum. The same bytes on every run. Precondition: one
/// component.
std::vector<double> fiedler_positions(const WeightedGraph& graph);

}  // namespace isthmus
