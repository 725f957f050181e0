#include "pipelines/pair_rounds.h"

#include <algorithm>
#include <utility>

namespace isthmus::pipelines {
namespace {

constexpr int kJoiningPairsPerWave = 2;       // of a scan outside the largest component
constexpr std::size_t kPredictedPerScan = 2;  // times pairs_per_scan: the second round's budget

}  // namespace

PairRounds::PairRounds(CandidateGraph graph, const CandidateOptions& options, std::size_t num_scans)
    : graph_(std::move(graph)), pairs_per_scan_(options.pairs_per_scan), num_scans_(num_scans) {}

std::vector<PlannedPair> PairRounds::first() {
  std::vector<PlannedPair> pairs;
  for (const Candidate& c : graph_.candidates) {
    pairs.push_back({c.source, c.target, c.score, c.why, std::nullopt});
    tried_.insert(std::minmax(c.source, c.target));
  }
  return pairs;
}

std::vector<PlannedPair> PairRounds::next(const Solution& solution, std::span<const OutlinedScan> scans) {
  std::vector<PlannedPair> pairs = predicted(solution, scans);
  std::vector<PlannedPair> joins = joining(solution);
  pairs.insert(pairs.end(), joins.begin(), joins.end());
  return pairs;
}

std::vector<PlannedPair> PairRounds::predicted(const Solution& solution, std::span<const OutlinedScan> scans) {
  std::vector<PlannedPair> pairs;
  const std::size_t budget = kPredictedPerScan * static_cast<std::size_t>(pairs_per_scan_) * num_scans_;
  for (const GuidedPair& guided : propose_guided_pairs(solution, scans, pairs_per_scan_)) {
    const Pair pair = std::minmax(guided.source, guided.target);
    if (tried_predicted_.size() >= budget || !tried_predicted_.insert(pair).second) continue;
    pairs.push_back({guided.source, guided.target, guided.predicted_overlap, "predicted", guided.target_from_source});
  }
  return pairs;
}

std::vector<PlannedPair> PairRounds::joining(const Solution& solution) {
  std::map<int, int> component;
  for (const PlacedScan& scan : solution.scans) component[scan.id] = scan.component;
  const std::size_t budget = static_cast<std::size_t>(pairs_per_scan_) * num_scans_;
  std::map<int, int> wanted;
  std::vector<PlannedPair> pairs;
  for (const Candidate& c : graph_.reserve) {  // best first
    if (tried_.size() >= budget) break;
    const int of_source = component[c.source], of_target = component[c.target];
    if (of_source == of_target || tried_.contains(std::minmax(c.source, c.target))) continue;
    // The largest component has number 0: its scans are placed, so it is the others that ask.
    const bool source_asks = of_source != 0 && wanted[c.source] < kJoiningPairsPerWave;
    const bool target_asks = of_target != 0 && wanted[c.target] < kJoiningPairsPerWave;
    if (!source_asks && !target_asks) continue;
    ++wanted[c.source], ++wanted[c.target];
    tried_.insert(std::minmax(c.source, c.target));
    pairs.push_back({c.source, c.target, c.score, "joins parts", std::nullopt});
  }
  return pairs;
}

}  // namespace isthmus::pipelines
