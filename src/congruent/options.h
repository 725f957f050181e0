// What a surveyor may turn in the congruent sets stage.
#pragma once

#include <string>

#include "config/option_table.h"

namespace isthmus {

struct CongruentOptions {
  double tolerance_voxels = 1.5;     ///< the caller multiplies by the voxel edge: register_congruent() takes metres
  double confidence = 0.99;          ///< wanted probability that at least one trial's base had its true counterpart
  int max_trials = 128;              ///< bases tried at most
  int max_pairs = 50000;             ///< pairs kept for one diagonal; a base with more is too common and is left
  int max_congruent_sets = 20000;    ///< congruent sets kept for one base; a base with more is left
  double thinning_tolerances = 1.4;  ///< edge of the cells that keep one target point each for pairs; 0 = keep all
  int max_target_points = 2000;      ///< points of the target that pairs are drawn from; more are thinned by lot
  int score_samples = 500;           ///< source points that score a transform
  int max_scored = 50;               ///< transforms of one base scored by all samples: the best by a first look
  int max_transforms = 10;           ///< distinct transforms returned
  int refine_steps = 10;             ///< point-to-plane steps on each transform returned; 0 = none
  std::string bases = "area";        ///< where corners of bases come from: area or boundary
  double base_width = 0.7;           ///< longest side of a base, share of the overlap's diameter
  double stop_score = 0.95;          ///< stop after the batch of trials that reached this score
  int stop_votes = 4;                ///< stop when the bases of this many trials led to the best transform; 0 = never
  double min_score = 0.05;           ///< transforms below are not returned
  bool use_normals = true;
  double normal_tolerance_deg = 20;  ///< how far angles between normals and diagonals may differ
  double facing_tolerance_deg = 45;  ///< how far a source normal may turn from the target normal it lies on
};
const config::OptionTable<CongruentOptions>& congruent_options_table();

}  // namespace isthmus
