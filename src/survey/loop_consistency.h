// Loops judge links: finds the links that contradict a consistent majority, before anything is optimised.
#pragma once

#include <span>
#include <vector>

#include "survey/link_model.h"
#include "survey/spanning_forest.h"

namespace isthmus::survey {

/// How a link or a path misses what other links say.
struct LoopError {
  std::vector<int> loop;  ///< nodes of the path that contradicts the link, from its source to its target
  double rotation_rad = 0;
  double translation_m = 0;
  double chi2 = 0;
};

struct LoopRejection {
  int measurement = 0;
  LoopError error;
  bool undecided = false;  ///< the loop does not close, and the evidence does not say which of its links is wrong
};

struct LoopJudgement {
  std::vector<int> tree;                  ///< measurements of the spanning forest that most links agree with, ascending
  std::vector<LoopRejection> rejections;  ///< ascending measurement
};

/// Difference between a measurement and the path a..b of other measurements.
LoopError error_against_path(std::span<const Measurement> measurements, const Measurement& m,
                             const std::vector<int>& path);

/// Searches the spanning forest with which the largest weight of links agrees (exchange of tree edges), then rejects
/// what disagrees with it. A link that closes no loop is never rejected. See docs/stages/pose_graph.md.
LoopJudgement judge_loops(int num_nodes, std::span<const Measurement> measurements, const SolveOptions& options);

/// What one more agreeing link adds to the log odds of a group of links: how unlikely agreement by chance is, and its
/// own odds.
double vote_of(const Measurement& m, const SolveOptions& options);

}  // namespace isthmus::survey
