// Links judge each other: the spanning forest that most of them agree with, before anything is optimised.
#pragma once

#include <span>
#include <vector>

#include "survey/cut_groups.h"

namespace isthmus::survey {

/// How a link misses what other links say.
struct LoopError {
  std::vector<int> loop;  ///< nodes of the path that contradicts the link, from its source to its target
  double rotation_rad = 0;
  double translation_m = 0;
};

struct LoopRejection {
  int measurement = 0;
  LoopError error;
  bool undecided = false;  ///< links contradict each other and the evidence does not say which of them is wrong
};

/// An ambiguous link that holds two parts together because others agree with it.
struct Promotion {
  int measurement = 0;
  std::vector<int> confirmed_by;  ///< links across the same cut
};

struct Consensus {
  std::vector<int> tree;                  ///< measurements of the forest, ascending
  std::vector<LoopRejection> rejections;  ///< links that the pair stage accepted, ascending
  std::vector<Promotion> promotions;      ///< ambiguous links of the tree, ascending
  /// Every cut of the forest holds by three or more links that agree, and no rival has more than half as many.
  bool solid = true;
};

/// Searches the forest with the largest summed votes of agreeing links, ambiguous ones included (exchange of tree
/// edges), then drops what is not certain enough. A link that closes no loop and has no rival is never rejected.
/// Method: docs/stages/pose_graph.md.
Consensus find_consensus(int num_nodes, std::span<const Measurement> measurements, const SolveOptions& options);

}  // namespace isthmus::survey
