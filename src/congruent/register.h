// Super4PCS: from two overlapping clouds to the rigid transforms that explain them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "congruent/options.h"
#include "congruent/oriented_cloud.h"
#include "geometry/transform.h"

namespace isthmus {

/// A rough pose: only transforms near it are sought.
struct CongruentPrior {
  Transform target_from_source = Transform::Identity();
  double max_rotation_rad = 0;   ///< largest rotation away from the prior
  double max_translation_m = 0;  ///< largest displacement of the source's mean point away from where the prior puts it
};

/// Verticals that the two clouds share.
struct CongruentGravity {
  Eigen::Vector3d up_in_source = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up_in_target = Eigen::Vector3d::UnitZ();
  double tolerance_rad = 0;  ///< how far the two may disagree
};

/// What is known beforehand. Both parts only prune: pairs that contradict them are never formed.
struct CongruentSearch {
  std::optional<CongruentPrior> prior;
  std::optional<CongruentGravity> gravity;
};

struct ScoredTransform {
  Transform target_from_source = Transform::Identity();
  double score = 0;  ///< share of the source's sample points with a facing target point within the tolerance
  int trial = 0;     ///< the trial whose base gave it
  int votes = 0;     ///< trials whose bases led here; agreement of independent bases is evidence of its own
};

/// Work done, in counts; the same for any number of threads.
struct CongruentCounts {
  int trials_wanted = 0;  ///< by the confidence, before any score was known; more than max_trials: less sure
  int trials = 0;
  int trials_without_base = 0;  ///< no wide coplanar base was drawn
  int trials_too_common = 0;    ///< bases left because max_pairs or max_congruent_sets was exceeded
  std::uint64_t cell_tests = 0;
  std::uint64_t distance_tests = 0;
  std::uint64_t pairs = 0;
  std::uint64_t gap_tests = 0;
  std::uint64_t congruent_sets = 0;
  std::uint64_t transforms_looked_at = 0;  ///< scored by a few samples
  std::uint64_t transforms_scored = 0;     ///< scored by all
  std::uint64_t points_looked_up = 0;
};

struct CongruentResult {
  std::vector<ScoredTransform> transforms;  ///< distinct, best score first; empty = none found, see `reason`
  CongruentCounts counts;
  std::string reason = "not computed";  ///< why `transforms` is empty; empty when it is not
};

/// Registers `source` to `target` by congruent sets of four coplanar points (Aiger, Mitra, Cohen-Or 2008; Mellado,
/// Aiger, Mitra 2014). `tolerance_m` is how far two samples of one surface may lie apart: usually
/// options.tolerance_voxels times the voxel edge. `overlap` in (0, 1] is the share of the source that the target is
/// believed to show, about 1 for grown regions; it sets the width of the bases and the number of trials. The same bytes
/// for the same arguments, whatever the number of threads; randomness comes from `seed` alone.
CongruentResult register_congruent(const OrientedCloud& source, const OrientedCloud& target, double tolerance_m,
                                   double overlap, std::uint64_t seed, const CongruentOptions& options,
                                   const CongruentSearch& search = {});

}  // namespace isthmus
