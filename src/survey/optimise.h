// Robust least squares over poses: Ceres inside, graduated non-convexity around it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "survey/control_fit.h"
#include "survey/link_model.h"

namespace isthmus::survey {

struct OptimisedPoses {
  std::vector<Transform> root_from_node;  ///< per node, between centred frames
  std::vector<double> weights;            ///< per measurement, 0 = an outlier, 1 = fully believed
  double variance_factor = 1;             ///< of the links' own covariances, by what the loops show
  std::string problem;  ///< empty, or what the optimiser complained of: the poses are then its last ones
};

/// Minimises the sum over measurements of min(chi2, chi2_limit) by graduated non-convexity with truncated least squares
/// (Yang, Antonante, Tzoumas, Carlone 2020, "Graduated non-convexity for robust spatial perception", section IV, TLS
/// surrogate). `fixed` holds one node per part, whose pose stays as it is. Single-threaded, deterministic.
OptimisedPoses optimise(std::vector<Transform> root_from_node, std::span<const Measurement> measurements,
                        const std::vector<int>& fixed, double chi2_limit);

/// Least squares over believed links, each weighed by its own word (`own_sqrt_information`) times what the others make
/// of it: residuals are taken to follow a t distribution, so that a link that says too much of itself loses weight, and
/// their common scale is estimated with them (Lange, Little, Taylor 1989, "Robust statistical modeling using the t
/// distribution", section 2). Where loops are few the scale stays near that of the pair stage. The weights, over the
/// scale, turn `own_sqrt_information` into what was used: times their roots. `fixed` as above.
OptimisedPoses optimise_by_precision(std::vector<Transform> root_from_node, std::span<const Measurement> measurements,
                                     const std::vector<int>& fixed);

/// Least squares over links and control together, all of them believed; the weights stay empty. Poses are in the
/// shifted world. `held` (or -1) is a node that keeps its place and heading: where only levels are known.
OptimisedPoses optimise_with_control(std::vector<Transform> shifted_from_node,
                                     std::span<const Measurement> measurements, std::span<const ControlTerm> terms,
                                     int held);

/// Squared whitened residual of a measurement at given poses.
double chi2_at(const Measurement& m, const std::vector<Transform>& root_from_node);

}  // namespace isthmus::survey
