#include "pipelines/pair_rounds.h"

#include <algorithm>
#include <utility>

namespace isthmus::pipelines {
namespace {

constexpr int kJoiningPairsPerWave = 2;       // of a scan outside the largest component
constexpr int kSupposedPairsPerWave = 3;      // of any scan
constexpr std::size_t kPredictedPerScan = 2;  // times pairs_per_scan: the second round's budget

}  // namespace

PairRounds::PairRounds(CandidateGraph graph, const CandidateOptions& options, std::size_t num_scans)
    : graph_(std::move(graph)), pairs_per_scan_(options.pairs_per_scan), num_scans_(num_scans) {}

std::vector<PlannedPair> PairRounds::first() {
  std::vector<PlannedPair> pairs;
  for (const Candidate& c : graph_.candidates) {
    pairs.push_back({c.source, c.target, c.score, false, std::nullopt});
    tried_.insert(std::minmax(c.source, c.target));
  }
  return pairs;
}

std::vector<PlannedPair> PairRounds::next(const Solution& solution, std::span<const OutlinedScan> scans,
                                          std::span<const PartJoin> joins) {
  std::vector<PlannedPair> pairs = predicted(solution, scans);
  for (const std::vector<PlannedPair>& more : {supposed(joins), joining(solution)})
    pairs.insert(pairs.end(), more.begin(), more.end());
  return pairs;
}

std::size_t PairRounds::left_of_second_budget() const {
  const std::size_t budget = kPredictedPerScan * static_cast<std::size_t>(pairs_per_scan_) * num_scans_;
  return budget - std::min(budget, tried_predicted_.size() + num_second_);
}

std::vector<PlannedPair> PairRounds::predicted(const Solution& solution, std::span<const OutlinedScan> scans) {
  std::vector<PlannedPair> pairs;
  for (const GuidedPair& guided : propose_guided_pairs(solution, scans, pairs_per_scan_)) {
    const Pair pair = std::minmax(guided.source, guided.target);
    if (left_of_second_budget() == 0 || !tried_predicted_.insert(pair).second) continue;
    pairs.push_back({guided.source, guided.target, guided.predicted_overlap, true, guided.target_from_source});
  }
  return pairs;
}

std::vector<PlannedPair> PairRounds::supposed(std::span<const PartJoin> joins) {
  std::map<Pair, PlannedPair> by_pair;  // several links may suppose a pair: the likeliest counts
  for (const PartJoin& join : joins)
    for (const GuidedPair& across : join.across) {
      const Pair pair = std::minmax(across.source, across.target);
      if (tried_.contains(pair)) continue;
      const double score = across.predicted_overlap * join.link->link.result.probability;
      PlannedPair& planned = by_pair[pair];
      if (score > planned.score) planned = {across.source, across.target, score, true, std::nullopt};
    }
  std::vector<PlannedPair> pairs;
  for (const auto& [pair, planned] : by_pair)
    if (planned.score > 0) pairs.push_back(planned);
  std::ranges::stable_sort(pairs, std::ranges::greater(), &PlannedPair::score);
  std::map<int, int> wanted;
  std::erase_if(pairs, [&](const PlannedPair& p) {
    if (std::max(wanted[p.source], wanted[p.target]) >= kSupposedPairsPerWave || left_of_second_budget() == 0)
      return true;
    ++wanted[p.source], ++wanted[p.target], ++num_second_;
    tried_.insert(std::minmax(p.source, p.target));
    return false;
  });
  return pairs;
}

std::vector<PlannedPair> PairRounds::joining(const Solution& solution) {
  std::map<int, int> component;
  for (const PlacedScan& scan : solution.scans) component[scan.id] = scan.component;
  const std::size_t budget = static_cast<std::size_t>(pairs_per_scan_) * num_scans_;
  std::map<int, int> wanted;
  std::vector<PlannedPair> pairs;
  for (const Candidate& c : graph_.reserve) {  // best first
    const bool late = tried_.size() - num_second_ >= budget;
    if (late && left_of_second_budget() == 0) break;
    const int of_source = component[c.source], of_target = component[c.target];
    if (of_source == of_target || tried_.contains(std::minmax(c.source, c.target))) continue;
    // The largest component has number 0: its scans are placed, so it is the others that ask.
    const auto asks = [&](int scan, int of_scan) {
      return of_scan != 0 && wanted[scan] < kJoiningPairsPerWave && (!late || num_late_joins_[scan] < pairs_per_scan_);
    };
    if (!asks(c.source, of_source) && !asks(c.target, of_target)) continue;
    ++wanted[c.source], ++wanted[c.target];
    if (late) ++num_second_, ++num_late_joins_[c.source], ++num_late_joins_[c.target];
    tried_.insert(std::minmax(c.source, c.target));
    pairs.push_back({c.source, c.target, c.score, late, std::nullopt});
  }
  return pairs;
}

}  // namespace isthmus::pipelines
