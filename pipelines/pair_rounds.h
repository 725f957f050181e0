// Which pairs are tried next. A survey too large for all pairs begins with the most promising ones of every scan; from
// then on, the poses found so far say where the remaining tries are worth most.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/guided_pairs.h"
#include "survey/candidates.h"

namespace isthmus::pipelines {

struct PlannedPair {
  int source = 0;
  int target = 0;
  double score = 0;                             ///< likeness, or the predicted overlap
  std::string why;                              ///< as in Candidate, "joins parts", "predicted"
  std::optional<Transform> target_from_source;  ///< where the solved poses point; absent in the first round
};

/// Waves of pairs, each chosen when the results of those before are known. Two budgets, both pairs_per_scan x scans or
/// a multiple of it: one for pairs that nothing but likeness proposes (first round), one for pairs that solved poses
/// propose (second round, twice as many). Depends on nothing but the graph, the options and the solutions.
class PairRounds {
 public:
  PairRounds(CandidateGraph graph, const CandidateOptions& options, std::size_t num_scans);

  /// The candidates themselves.
  std::vector<PlannedPair> first();

  /// After each solution: pairs within components that its poses predict to overlap and that were not looked at with a
  /// prediction before; and, from what is left of the first budget, for every scan outside the largest component its
  /// most promising untried pairs that would join it to another component. Empty when nothing is left to try. `scans`
  /// ascending by id.
  std::vector<PlannedPair> next(const Solution& solution, std::span<const OutlinedScan> scans);

 private:
  using Pair = std::pair<int, int>;  // smaller id first

  std::vector<PlannedPair> predicted(const Solution& solution, std::span<const OutlinedScan> scans);
  std::vector<PlannedPair> joining(const Solution& solution);

  CandidateGraph graph_;
  int pairs_per_scan_;
  std::size_t num_scans_;
  std::set<Pair> tried_;            // without a prediction
  std::set<Pair> tried_predicted_;  // with one
};

}  // namespace isthmus::pipelines
