#include "regions/divide.h"

#include <algorithm>
#include <stdexcept>

#include "regions/divisions.h"

namespace isthmus {

RegionMap divide(const SampledScan& scan, const FeatureCloud& features, const RegionOptions& options) {
  const auto table = divisions();
  const auto found = std::ranges::find(table, options.division, &Division::name);
  if (found == table.end()) throw std::invalid_argument("there is no division '" + options.division + "'");
  return features.keypoints.empty() ? RegionMap{} : found->divide(scan, features, options);
}

}  // namespace isthmus
