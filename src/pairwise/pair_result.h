// What is known about one pair when all is done.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/transform.h"

namespace isthmus {

enum class Verdict : std::uint8_t {
  failed,     ///< not computed, or an input was unusable; `reason` says why
  rejected,   ///< no hypothesis stands up to the evidence (or there was none)
  ambiguous,  ///< a plausible transform, but a rival or a sliding direction forbids to trust it
  accepted,
};
const char* to_string(Verdict verdict);

/// Another pose of a pair, elsewhere than its best. At most so many are kept, and none that scores less than this share
/// of the best.
inline constexpr std::size_t kMostRivals = 6;
inline constexpr double kLeastRivalShare = 0.2;
struct RivalPose {
  Transform target_from_source = Transform::Identity();  ///< between the local frames
  double score = 0;                                      ///< by the measure that ranked the best
  template <class F>
  void fields(F&& f) {
    f(target_from_source), f(score);
  }
};

/// Result of registering a source scan to a target scan. Starts as "not computed".
struct PairResult {
  Verdict verdict = Verdict::failed;
  std::string reason = "not computed";
  double probability = 0;                       ///< that target_from_source is right (calibrated, see docs)
  std::optional<Transform> target_from_source;  ///< best hypothesis between the *local* frames, whatever the verdict
  /// Inverse covariance of target_from_source under a right perturbation, T * exp(d): d = (translation in metres,
  /// rotation vector in radians), both in the source frame, translation first.
  Matrix6d information = Matrix6d::Zero();
  double overlap_of_source = 0;  ///< share of source points with a facing target point
  double overlap_of_target = 0;
  double overlap = 0;                                            ///< the smaller of the two
  double rms_m = 0;                                              ///< point-to-plane over the overlap
  std::vector<std::pair<std::string, double>> evidence;          ///< named terms, in a fixed order
  std::vector<RivalPose> rivals;                                 ///< best first, each a basin of its own
  std::vector<std::pair<std::string, double>> seconds_by_stage;  ///< timings: never in deterministic outputs
  std::vector<std::pair<std::string, double>> counts;            ///< work counts: hypotheses, trials, ...

  template <class F>
  void fields(F&& f) {
    f(verdict), f(reason), f(probability), f(target_from_source), f(information), f(overlap_of_source);
    f(overlap_of_target), f(overlap), f(rms_m), f(evidence), f(rivals), f(seconds_by_stage), f(counts);
  }
};

}  // namespace isthmus
