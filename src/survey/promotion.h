// Ambiguous links that the solved survey confirms become accepted.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "survey/link_model.h"

namespace isthmus::survey {

/// The survey as solved so far.
struct SolvedParts {
  int num_nodes = 0;
  std::vector<int> part;                      ///< per node
  std::vector<Transform> root_from_node;      ///< per node, within its part, centred frames
  std::span<const Measurement> measurements;  ///< accepted and ambiguous
  std::vector<char> accepted;                 ///< per measurement: carries the poses
};

struct Promotion {
  int measurement = 0;
  std::vector<int> confirmed_by;  ///< measurements: the path or the other links that agree
  bool joins = false;             ///< it (with others) joined two parts
  double probability = 0;         ///< that it is right, given the agreement
};

/// Ambiguous links with both ends in one part that agree with the poses.
std::vector<Promotion> confirmed_within_parts(const SolvedParts& parts, const std::vector<NoiseModel>& noise,
                                              const SolveOptions& options);

/// Ambiguous links that join parts: at least two links between two parts whose joint transforms agree, or three links
/// around three parts whose loop closes; only those of the most probable join are returned, empty if none is probable
/// enough.
std::vector<Promotion> best_join(const SolvedParts& parts, const std::vector<NoiseModel>& noise,
                                 const SolveOptions& options);

}  // namespace isthmus::survey
