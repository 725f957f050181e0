#include "io/local_origin.h"

#include <algorithm>
#include <cmath>

namespace isthmus::io {
namespace {

constexpr double kRoundTo_m = 100.0;

}  // namespace

Eigen::Vector3d local_origin_of(const std::vector<Eigen::Vector3d>& sample) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (const Eigen::Vector3d& p : sample) {
      if (p.allFinite() && !p.isZero(0.0)) values.push_back(p[axis]);
    }
    if (values.empty()) continue;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (std::abs(*middle) > kFarFromZero_m) origin[axis] = std::round(*middle / kRoundTo_m) * kRoundTo_m;
  }
  return origin;
}

}  // namespace isthmus::io
