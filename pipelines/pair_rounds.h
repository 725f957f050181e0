// Which pairs are tried next. A survey too large for all pairs begins with the most promising ones of every scan; from
// then on, the poses found so far say where the remaining tries are worth most.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "pipelines/guided_pairs.h"
#include "pipelines/part_joins.h"
#include "survey/candidates.h"

namespace isthmus::pipelines {

struct PlannedPair {
  int source = 0;
  int target = 0;
  double score = 0;                             ///< promise, or the predicted overlap
  bool second_round = false;                    ///< proposed by solved poses or by links found before
  std::optional<Transform> target_from_source;  ///< where the solved poses point; absent in the first round
};

/// Waves of pairs, each chosen when the results of those before are known. Two budgets, both pairs_per_scan x scans or
/// a multiple of it: one for pairs that nothing but likeness proposes (first round), one for pairs that solved poses
/// and links found before propose (second round, twice as many). Depends on nothing but the graph, the options and the
/// solutions.
class PairRounds {
 public:
  PairRounds(CandidateGraph graph, const CandidateOptions& options, std::size_t num_scans);

  /// The candidates themselves.
  std::vector<PlannedPair> first();

  /// After each solution, from the second budget: pairs within components that its poses predict to overlap and that
  /// were not looked at with a prediction before; untried pairs that would overlap if an ambiguous link between two
  /// components were right, without telling them where, so that they can bear witness. From what is left of the first
  /// budget, and then a share of the second, for every scan outside the largest component its most promising untried
  /// pairs that would join it to another component. Empty when nothing is left to try. `scans` ascending by id.
  /// `joins` between the solution's components.
  std::vector<PlannedPair> next(const Solution& solution, std::span<const OutlinedScan> scans,
                                std::span<const PartJoin> joins);

 private:
  using Pair = std::pair<int, int>;  // smaller id first

  std::vector<PlannedPair> predicted(const Solution& solution, std::span<const OutlinedScan> scans);
  std::vector<PlannedPair> supposed(std::span<const PartJoin> joins);
  std::vector<PlannedPair> joining(const Solution& solution);
  [[nodiscard]] std::size_t left_of_second_budget() const;

  CandidateGraph graph_;
  int pairs_per_scan_;
  std::size_t num_scans_;
  std::set<Pair> tried_;               // without a prediction
  std::set<Pair> tried_predicted_;     // with one
  std::size_t num_second_ = 0;         // of tried_, from the second budget
  std::map<int, int> num_late_joins_;  // of a scan outside the largest component, from the second budget
};

}  // namespace isthmus::pipelines
