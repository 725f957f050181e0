#include "regions/fiedler.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/rng.h"

namespace isthmus {
namespace {

constexpr Eigen::Index kSteps = 40;      // basis vectors a round
constexpr int kRounds = 3;               // each begins with the last one's answer
constexpr std::uint64_t kStartSeed = 1;  // any start that is not orthogonal to the answer will do
constexpr double kExhausted = 1e-12;     // the basis holds all that the start can reach

// (I + D^-1/2 W D^-1/2) / 2, whose eigenvalues lie in [0, 1].
Eigen::VectorXd applied(const WeightedGraph& graph, const Eigen::VectorXd& root_degree, const Eigen::VectorXd& v) {
  Eigen::VectorXd out(v.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    double sum = 0;
    for (const auto& [j, weight] : graph.around(static_cast<std::size_t>(i))) sum += weight * v[j] / root_degree[j];
    out[i] = 0.5 * (v[i] + sum / root_degree[i]);
  }
  return out;
}

// One round of Lanczos' method within the complement of `first`; the vector with the largest Ritz value.
Eigen::VectorXd lanczos_round(const WeightedGraph& graph, const Eigen::VectorXd& root_degree,
                              const Eigen::VectorXd& first, Eigen::VectorXd v) {
  const Eigen::Index n = v.size(), most = std::min(kSteps, n - 1);
  Eigen::MatrixXd basis(n, most);
  Eigen::VectorXd diagonal(most), beside(most);
  v -= first.dot(v) * first;
  v.normalize();
  Eigen::Index m = 0;
  while (m < most) {
    basis.col(m) = v;
    Eigen::VectorXd w = applied(graph, root_degree, v);
    diagonal[m] = v.dot(w);
    ++m;
    for (int twice = 0; twice < 2; ++twice) {  // once loses digits that the second time restores
      w -= first.dot(w) * first;
      w -= basis.leftCols(m) * (basis.leftCols(m).transpose() * w);
    }
    const double length = w.norm();
    if (length < kExhausted) break;
    beside[m - 1] = length;
    v = w / length;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal.head(m), beside.head(m - 1));
  return basis.leftCols(m) * solver.eigenvectors().col(m - 1);
}

}  // namespace

WeightedGraph::WeightedGraph(std::size_t num_nodes, std::span<const Tie> ties)
    : begin_(num_nodes + 1, 0), degree_(num_nodes, 0) {
  std::vector<Tie> both;
  for (const Tie& tie : ties)
    if (tie.a != tie.b) both.push_back(tie), both.push_back({tie.b, tie.a, tie.weight});
  std::ranges::sort(both, {}, [](const Tie& t) { return std::tuple(t.a, t.b, -t.weight); });
  const auto same = [](const Tie& s, const Tie& t) { return s.a == t.a && s.b == t.b; };
  both.erase(std::unique(both.begin(), both.end(), same), both.end());
  for (const Tie& tie : both) {
    ++begin_[tie.a + 1];
    ties_.emplace_back(tie.b, tie.weight);
    degree_[tie.a] += tie.weight;
  }
  for (std::size_t i = 0; i < num_nodes; ++i) begin_[i + 1] += begin_[i];
}

std::vector<std::vector<std::uint32_t>> WeightedGraph::components() const {
  std::vector<std::vector<std::uint32_t>> parts;
  std::vector<char> known(size(), 0);
  for (std::uint32_t start = 0; start < size(); ++start) {
    if (known[start]) continue;
    known[start] = 1;
    auto& part = parts.emplace_back(1, start);
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const auto& [j, weight] : around(part[k]))
        if (!known[j]) known[j] = 1, part.push_back(j);
    std::ranges::sort(part);
  }
  return parts;
}

WeightedGraph WeightedGraph::part(std::span<const std::uint32_t> nodes) const {
  constexpr std::uint32_t kOutside = ~0U;
  std::vector<std::uint32_t> number(size(), kOutside);
  for (std::uint32_t k = 0; k < nodes.size(); ++k) number[nodes[k]] = k;
  std::vector<Tie> ties;
  for (std::uint32_t k = 0; k < nodes.size(); ++k)
    for (const auto& [j, weight] : around(nodes[k]))
      if (number[j] != kOutside && k < number[j]) ties.push_back({k, number[j], weight});
  return WeightedGraph(nodes.size(), ties);
}

std::vector<double> fiedler_positions(const WeightedGraph& graph) {
  const auto n = static_cast<Eigen::Index>(graph.size());
  if (n < 2) return std::vector<double>(graph.size(), 0);
  Eigen::VectorXd root_degree(n), v(n);
  Rng rng(kStartSeed);
  for (Eigen::Index i = 0; i < n; ++i) {
    root_degree[i] = std::sqrt(std::max(graph.degree(static_cast<std::size_t>(i)), std::numeric_limits<double>::min()));
    v[i] = rng.uniform(-1, 1);
  }
  const Eigen::VectorXd first = root_degree.normalized();
  for (int round = 0; round < kRounds; ++round) v = lanczos_round(graph, root_degree, first, v);
  const Eigen::VectorXd position = v.cwiseQuotient(root_degree);
  return {position.data(), position.data() + n};
}

}  // namespace isthmus
