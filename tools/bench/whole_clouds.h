// The baseline: Super4PCS on whole sampled clouds, without features, regions or free space.
#pragma once

#include "bench/pair_trial.h"

namespace isthmus::bench {

/// The budget of the baseline. Its verification is its own: the largest common point set of facing points.
struct WholeClouds {
  double overlap = 0.35;  ///< assumed of every pair: best of those measured on whole scans, docs/stages/congruent.md
  int max_trials = 256;   ///< bases tried at most; further limits are the defaults of CongruentOptions
};

/// The same scans, sampled with the same voxel, as run_trial() gets. Its best transform is the answer; it gives no
/// verdict, so it accepts nothing.
PairTrial run_whole_clouds(const BenchSet& set, std::size_t source, std::size_t target, const WholeClouds& options);

}  // namespace isthmus::bench
