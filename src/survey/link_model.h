// What a link says, in the frames in which the solver works: every scan's frame is moved to the scan's centre, so that
// the noise floor is isotropic there and far local origins do not spoil the conditioning.
#pragma once

#include "geometry/transform.h"
#include "survey/pose_graph.h"

namespace isthmus::survey {

/// A relative pose b_from_a with the covariance of its right perturbation b_from_a * exp(d), d in frame a, translation
/// first.
struct Relative {
  Transform b_from_a = Transform::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

/// One usable link between nodes (indices into the sorted scans).
struct Measurement {
  int link = 0;                                  ///< index into the sorted links
  int source = 0;                                ///< node
  int target = 0;                                ///< node
  Relative target_from_source;                   ///< between centred frames, noise floor included
  Matrix6d sqrt_information = Matrix6d::Zero();  ///< W with W' W = covariance^-1
  /// The same by the link's own word, with a floor far below: how links weigh against each other once they are
  /// believed.
  Matrix6d own_sqrt_information = Matrix6d::Zero();
  /// That word as the loops let it stand, for uncertainties: over the variance factor, and less where the link itself
  /// stands out; zero before they were asked.
  Matrix6d proven_sqrt_information = Matrix6d::Zero();
  double floor_m = 0;     ///< noise floor at the source's centre: the unit of tight agreement
  double floor_rad = 0;   ///< the same for the rotation
  double log_odds = 0;    ///< log p/(1-p) of the pair stage's probability, clipped; 0 for guided links
  bool accepted = false;  ///< by the pair stage; otherwise ambiguous
  bool votes = true;      ///< false for guided links, and those that free space forbids or alone decided
  /// Accepted by the pair stage, whose word counts for little in this survey: treated as ambiguous.
  bool doubted = false;
  double overlap = 0;  ///< breaks ties
};

/// Adjoint of a transform for (translation, rotation) vectors: T exp(d) T^-1 = exp(Ad(T) d).
Matrix6d adjoint(const Transform& t);

/// c_from_a of b_from_a and c_from_b, both uncertain and independent.
Relative compose(const Relative& c_from_b, const Relative& b_from_a);
Relative inverse(const Relative& b_from_a);

/// Translation and rotation vector of measured^-1 * predicted: the right perturbation that turns one into the other.
Vector6d disagreement(const Transform& measured, const Transform& predicted);

/// The larger of d's translation and rotation in noise floors, at the centre of the measurement's source.
double floors_of(const Vector6d& d, const Measurement& m);

/// Whether d is so small that agreement is evidence, whatever the uncertainties: within four noise floors (two voxels
/// by default) at the centre of the measurement's source and, for the rotation, at the scan's radius.
bool is_tight(const Vector6d& d, const Measurement& m);

/// d' C^-1 d
double chi2_of(const Vector6d& d, const Matrix6d& covariance);

/// Standard deviations added to every link's own, and the widest that an unobserved direction may have.
struct NoiseModel {
  double floor_m = 0;
  double floor_rad = 0;
  double ceiling_m = 0;
  double ceiling_rad = 0;
};
NoiseModel noise_model(const PoseGraph& graph, const GraphScan& source, const SolveOptions& options);

/// Builds the measurement of a link; the text says why it cannot be used, empty if it can.
struct MeasurementOrReason {
  Measurement measurement;
  std::string reason;
};
MeasurementOrReason measurement_of(const Link& link, const GraphScan& source, const GraphScan& target,
                                   const NoiseModel& noise);

/// log p/(1-p), p clipped to [0.01, 0.9999]: no pair stage knows more than that.
double clipped_log_odds(double probability);
/// Its inverse, without the clipping.
double probability_of(double log_odds);

}  // namespace isthmus::survey
