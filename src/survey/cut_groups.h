// Links across a cut of the graph, grouped by the joint transform they agree on.
#pragma once

#include <span>
#include <vector>

#include "survey/link_model.h"
#include "survey/spanning_forest.h"

namespace isthmus::survey {

/// The links that may be believed.
struct LinksInPlay {
  int num_nodes = 0;
  std::span<const Measurement> measurements;
  const SolveOptions* options = nullptr;
  std::vector<int> active;  ///< ascending
};

/// Which side of a cut a node is on.
enum class Side : signed char { neither, low, high };

/// Removing one tree edge splits its tree: low is the subtree below the edge.
std::vector<Side> sides_of_edge(const SpanningForest& forest, int tree_edge);
/// Two trees of the forest, by their roots.
std::vector<Side> sides_of_parts(const SpanningForest& forest, int low_root, int high_root);

struct CutGroup {
  std::vector<int> members;  ///< the representative first, then most probable first; all agree with the representative
  std::vector<int> confirming;  ///< those members that agree tightly, the representative included
  double score = 0;             ///< log odds that the group is right rather than wrong and in agreement by chance
  bool has_accepted = false;    ///< by the pair stage, and not guided
};

/// Groups the active links across a cut. `first` (a tree edge of the cut, or -1) represents the first group. The
/// representative brings its own log odds, every other link that agrees tightly its log odds and the improbability of
/// agreeing by chance.
std::vector<CutGroup> groups_across(const LinksInPlay& links, const SpanningForest& forest,
                                    const std::vector<Side>& sides, int first);

/// Log odds that a link brings alone; links that the pair stage accepted never count against themselves.
double own_vote(const Measurement& m);
/// Log odds that a link adds to others with which it agrees.
double agreeing_vote(const Measurement& m, const SolveOptions& options);

}  // namespace isthmus::survey
