// What stands upright in a scan, found once for all pairs of the scan.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "regions/ground_plan.h"
#include "regions/stems.h"

namespace isthmus {

/// Stems and ground plans of one scan, by the turn that makes its vertical z and by how they were asked for. What is
/// not there is made by the caller's function; two callers at once may both make it, and have the same. Any thread.
class UprightMemo {
 public:
  UprightMemo() = default;
  UprightMemo(const UprightMemo&) {}  ///< of a scan that may be changed: begins anew
  UprightMemo& operator=(const UprightMemo&);
  ~UprightMemo() = default;

  std::shared_ptr<const std::vector<Stem>> stems(const Eigen::Matrix3f& z_from_scan, int min_layers,
                                                 const std::function<std::vector<Stem>()>& make);
  std::shared_ptr<const GroundPlan> plan(const Eigen::Matrix3f& z_from_scan, const GroundPlanOptions& options,
                                         const std::function<GroundPlan()>& make);

 private:
  using Key = std::array<float, 12>;  ///< of the turn, and up to three options
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<const std::vector<Stem>>> stems_;
  std::map<Key, std::shared_ptr<const GroundPlan>> plans_;
};

}  // namespace isthmus
