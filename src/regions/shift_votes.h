// Hough voting for the shift between two ground plans under a given turn.
#pragma once

#include <vector>

#include "regions/ground_plan.h"

namespace isthmus {

/// Every two columns that may be one vote for the shift between them, with the product of their weights. The target's
/// are sorted into bins of heading, so that only columns that face the same way meet; a column without one heading (a
/// trunk seen from all sides) meets the others without.
class ShiftVotes {
 public:
  ShiftVotes(const GroundPlan& source, const GroundPlan& target, float cell_m);

  /// What one turn after another is counted in: allocated once, since fresh pages cost more than the counting.
  [[nodiscard]] std::vector<float> grid() const;

  /// The `count` heaviest shifts under this turn: local maxima of sums over 3 x 3 cells. Deterministic, whatever `grid`
  /// was used for before.
  [[nodiscard]] std::vector<PlanPose> peaks(float yaw, std::size_t count, std::vector<float>& grid) const;

 private:
  static constexpr int kBins = 32;
  static constexpr int kReachBins = 3;  // headings within about 0.6 rad may be one

  static std::size_t bin_of(float heading);
  [[nodiscard]] float offset() const { return 1 + reach_m_ / cell_m_; }
  [[nodiscard]] std::vector<PlanPose> heaviest(const std::vector<float>& votes, float yaw, std::size_t count) const;

  const GroundPlan& source_;
  const GroundPlan& target_;
  float cell_m_, reach_m_;
  std::size_t size_ = 0;
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::uint32_t> open_;
};

/// Turns in steps at which the headings of the two plans agree: all of them in a wood, four in a house.
std::vector<float> likely_turns(const GroundPlan& source, const GroundPlan& target, float step_rad);

/// The heaviest `keep` of the peaks of all these turns, `per_turn` of each at most.
std::vector<PlanPose> heaviest_shifts(const ShiftVotes& votes, const std::vector<float>& turns, std::size_t per_turn,
                                      std::size_t keep);

}  // namespace isthmus
