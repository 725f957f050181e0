// Does a pose that others propose hold for a pair that was never linked?
#pragma once

#include "geometry/transform.h"
#include "regions/scan_model.h"

namespace isthmus {

struct PoseCheck {
  double support = 0;        ///< share of points with a facing surface of the other scan, the smaller direction
  double contradiction = 0;  ///< share that stands where the other station saw through, the larger direction

  /// Stricter than the veto of a pair's own verdict, since one wrong witness accuses a link between others: of 167
  /// pairs in true poses none, of 195 pairs of an office shifted by one room 51 (docs/stages/pose_graph.md).
  [[nodiscard]] bool forbidden() const {
    constexpr double kContradiction = 0.05, kShare = 0.1;
    return contradiction > kContradiction && contradiction > kShare * (contradiction + support);
  }
  template <class F>
  void fields(F&& f) {
    f(support), f(contradiction);
  }
};

/// Coarse models. A few milliseconds.
PoseCheck check_pose(const ScanModel& source, const ScanModel& target, const Transform& target_from_source);

}  // namespace isthmus
