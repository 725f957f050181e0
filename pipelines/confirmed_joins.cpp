#include "pipelines/confirmed_joins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pairwise/judge.h"

namespace isthmus::pipelines {
namespace {

constexpr double kLeastProbability =
    0.15;  // of a link that can be confirmed or stand against another: below it nothing fixes the place
// In an office of 38 stations 7 of 11 right and 6 of 647 wrong poses of pairs between parts have such a pair and none
// that is forbidden, between small parts 6 of 11 and 8 of 144. Further pairs see much of the same.
constexpr double kOddsOfFirst = 8, kOddsOfMore = 2;
constexpr std::size_t kMostWitnesses = 5;  // that count

double odds_of_witnesses(std::size_t count) {
  if (count == 0) return 1;
  return kOddsOfFirst * std::pow(kOddsOfMore, static_cast<double>(std::min(count, kMostWitnesses) - 1));
}

/// Pairs that speak for a join: none where any is forbidden.
std::size_t witnesses_for(const Testimony& said) { return said.num_forbidden > 0 ? 0 : said.num_meeting; }

struct Candidate {
  const PartJoin* join = nullptr;
  std::pair<int, int> parts;        ///< smaller number first
  Transform second_from_first;      ///< between the parts
  Eigen::Vector3d middle_of_first;  ///< of the scan at the link's end there
  std::size_t num_witnesses = 0;
  double probability = 0;
};

Candidate candidate_of(const PartJoin& join, const Testimony& said, const Solution& solution,
                       const Summaries& summaries) {
  const Link& link = join.link->link;
  const PlacedScan *source = solution.find(link.source), *target = solution.find(link.target);
  Candidate candidate;
  candidate.join = &join;
  candidate.parts = std::minmax(source->component, target->component);
  candidate.second_from_first =
      target->component_from_local * join.target_from_source * source->component_from_local.inverse();
  const PlacedScan* first = source;
  if (source->component > target->component) {
    candidate.second_from_first = candidate.second_from_first.inverse();
    first = target;
  }
  candidate.middle_of_first = first->component_from_local * summaries.at(first->id)->centre;
  candidate.num_witnesses = witnesses_for(said);
  candidate.probability = link.result.probability;
  return candidate;
}

/// Best score that may stand against the link's: among its rivals that nothing refutes, or among those that the pair
/// stage did not name.
double standing_rival(const PartJoin& join, std::span<const Testimony> of_rivals) {
  const PairResult& result = join.link->link.result;
  double score = kLeastRivalShare * join.score;
  if (result.rivals.size() == kMostRivals) score = std::max(score, result.rivals.back().score);
  for (std::size_t k = 0; k < of_rivals.size(); ++k)
    if (!of_rivals[k].refutes()) score = std::max(score, result.rivals[k].score);
  return score;
}

/// Most witnesses of a rival that may stand: what they see of the other part fits there as well, so that as many of the
/// link's own say nothing.
std::size_t witnesses_for_a_rival(std::span<const Testimony> of_rivals) {
  std::size_t most = 0;
  for (const Testimony& said : of_rivals)
    if (!said.refutes()) most = std::max(most, witnesses_for(said));
  return most;
}

/// Whether two links lay the parts onto each other alike.
bool agree(const Candidate& a, const Candidate& b, double voxel_m) {
  constexpr double kVoxels = 12, kRad = 0.1;  // a wrong room is farther off
  const Transform d = a.second_from_first.inverse() * b.second_from_first;
  return (d * b.middle_of_first - b.middle_of_first).norm() < kVoxels * voxel_m &&
         rotation_angle_rad(d.linear()) < kRad;
}

std::string text_of(const Candidate& candidate) {
  return fmt::format(
      "laid onto each other as it says, {} more pairs of scans of the two parts meet and none stands where "
      "the other saw through",
      candidate.num_witnesses);
}

}  // namespace

std::vector<ConfirmedLink> confirmed_joins(std::span<const PartJoin> joins, const Solution& solution,
                                           std::span<const OutlinedScan> scans, const PoseChecker& check,
                                           double accept_probability) {
  const Summaries summaries = summaries_of(scans);
  std::vector<PartJoin> likely;
  for (const PartJoin& join : joins)
    if (join.link->link.result.probability >= kLeastProbability && !forbidden_by_free_space(join.link->link.result))
      likely.push_back(join);
  const std::vector<Testimony> said = testimonies_of(likely, check);
  std::vector<Candidate> candidates;
  std::vector<PartJoin> witnessed;
  for (std::size_t k = 0; k < likely.size(); ++k) {
    if (said[k].refutes()) continue;
    candidates.push_back(candidate_of(likely[k], said[k], solution, summaries));
    if (candidates.back().num_witnesses > 0) witnessed.push_back(likely[k]);
  }
  const std::vector<PartJoin> rivals = rival_joins(witnessed, solution, summaries);
  const std::vector<Testimony> of_rivals = testimonies_of(rivals, check);
  std::size_t next_rival = 0;
  for (Candidate& c : candidates) {
    if (c.num_witnesses == 0) continue;
    const PairResult& result = c.join->link->link.result;
    const auto own = std::span(of_rivals).subspan(next_rival, result.rivals.size());
    next_rival += result.rivals.size();
    const double p = probability_against(result, standing_rival(*c.join, own));
    const std::size_t for_a_rival = witnesses_for_a_rival(own);
    const std::size_t beyond = c.num_witnesses > for_a_rival ? c.num_witnesses - for_a_rival : 0;
    const double odds = p / std::max(1 - p, 1e-9) * odds_of_witnesses(beyond);
    c.probability = std::max(c.probability, odds / (1 + odds));
  }
  std::map<std::pair<int, int>, const Candidate*> best;
  for (const Candidate& c : candidates) {
    const Candidate*& of_parts = best[c.parts];
    if (of_parts == nullptr || c.probability > of_parts->probability) of_parts = &c;
  }
  std::vector<ConfirmedLink> confirmed;
  for (const auto& [parts, c] : best) {
    if (c->num_witnesses == 0 || c->probability < accept_probability) continue;
    const double voxel_m = summaries.at(c->join->link->link.source)->voxel_m;
    const bool contested = std::ranges::any_of(candidates, [&, c = c](const Candidate& other) {
      return other.parts == c->parts && !agree(*c, other, voxel_m);
    });
    if (contested) continue;
    confirmed.push_back({c->join->link->link.source, c->join->link->link.target, c->probability, text_of(*c)});
  }
  return confirmed;
}

}  // namespace isthmus::pipelines
