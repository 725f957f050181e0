// Ambiguous links that agree with the solved poses.
#pragma once

#include <span>
#include <vector>

#include "survey/link_model.h"

namespace isthmus::survey {

/// The survey as solved so far.
struct SolvedParts {
  int num_nodes = 0;
  std::vector<int> part;                      ///< per node
  std::vector<Transform> root_from_node;      ///< per node, within its part, centred frames
  std::span<const Measurement> measurements;  ///< believed and ambiguous
  std::vector<char> believed;                 ///< per measurement: carries the poses
};

struct ConfirmedLink {
  int measurement = 0;
  std::vector<int> path;  ///< believed measurements that close the loop, from its source to its target
};

/// Ambiguous links with both ends in one part that agree tightly with the poses and are probable enough, given the
/// agreement.
std::vector<ConfirmedLink> confirmed_within_parts(const SolvedParts& parts, const SolveOptions& options);

}  // namespace isthmus::survey
