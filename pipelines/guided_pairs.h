// The second round: once links connect scans, their poses predict which other pairs overlap, and where. Loops come from
// here.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pipelines/scan_products.h"
#include "survey/pose_graph.h"

namespace isthmus::pipelines {

struct GuidedPair {
  int source = 0;
  int target = 0;
  double predicted_overlap = 0;                          ///< of the scans' outlines, the smaller of the two directions
  Transform target_from_source = Transform::Identity();  ///< between local frames, as the poses say
};

/// A scan that may take part.
struct OutlinedScan {
  int id = 0;
  const ScanSummary* summary = nullptr;
  std::string name;  ///< for reasons; the id is used where it is empty
};

/// Below it hardly a pair is found (docs/method), and what hardly meets says nothing as a witness.
inline constexpr double kLeastPredictedOverlap = 0.1;

/// Share of the outlines that meet under the pose, the smaller of the two directions; 0 where the scans are out of each
/// other's reach. Below kLeastPredictedOverlap it may be that of one direction alone.
double predicted_overlap(const ScanSummary& source, const ScanSummary& target, const Transform& target_from_source);

/// Pairs within one component without an accepted link whose outlines overlap by a tenth or more, at most
/// `pairs_per_scan` best for each scan. `scans` ascending by id; the answer ascending by (source, target), source >
/// target.
std::vector<GuidedPair> propose_guided_pairs(const Solution& solution, std::span<const OutlinedScan> scans,
                                             int pairs_per_scan);

}  // namespace isthmus::pipelines
