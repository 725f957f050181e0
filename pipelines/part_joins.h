// Links that would join two parts if they were believed: what the scans around their ends would then see of each other.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "pipelines/guided_pairs.h"

namespace isthmus::pipelines {

using Summaries = std::map<int, const ScanSummary*>;
Summaries summaries_of(std::span<const OutlinedScan> scans);

bool believed(const SolvedLink& link);

/// The links of each scan; a scan without any is missing. They point into the solution.
using LinksOf = std::map<int, std::vector<const SolvedLink*>>;
LinksOf links_of_scans(const Solution& solution, const std::function<bool(const SolvedLink&)>& counts);

int other_end(const SolvedLink& link, int scan);

/// Scans that hang together with any of `starts` over links between scans that are not `barred`, and over how many.
std::map<int, int> link_distances(const LinksOf& links_of, std::vector<int> starts,
                                  const std::function<bool(int)>& barred = {});

/// Where a scan would stand: target_from_source between local frames; absent where the poses do not say.
using Posing = std::function<std::optional<Transform>(int source, int target)>;

/// Pairs of scans on the two sides of a link, at most two links from its ends, that would overlap by a tenth or more,
/// most overlap first; the link's own ends are left out. Source > target.
std::vector<GuidedPair> pairs_across(const std::map<int, int>& of_source, const std::map<int, int>& of_target,
                                     const Summaries& summaries, const Posing& posing);

/// One pose of an ambiguous link between two components.
struct PartJoin {
  const SolvedLink* link = nullptr;                      ///< of the solution
  Transform target_from_source = Transform::Identity();  ///< between local frames: the link's own, or a rival's
  double score = 0;                                      ///< of this pose, by the pair stage
  std::vector<GuidedPair> across;                        ///< as above, if the pose were right
};

/// Every ambiguous link between two components. Those that nothing lies around have nothing across.
std::vector<PartJoin> possible_joins(const Solution& solution, const Summaries& summaries);

/// Every link between two components that was accepted by itself, not told where to look, and refuted since by the
/// scans around it.
std::vector<PartJoin> refuted_between_parts(const Solution& solution, const Summaries& summaries);

/// The rivals of the links of `joins`, likewise, in their order.
std::vector<PartJoin> rival_joins(std::span<const PartJoin> joins, const Solution& solution,
                                  const Summaries& summaries);

}  // namespace isthmus::pipelines
