// Which of a scan's dominant axes is the instrument's vertical, and which end of it is up.
#pragma once

#include <vector>

#include "features/feature_cloud.h"
#include "scan/sampled_scan.h"

namespace isthmus {

/// Puts the axis that is most likely the vertical first. Where the station is known and looked all round, the vertical
/// is the axis along which it saw nothing: a terrestrial scanner is blind below itself (its tripod, its own body), a
/// spinning one above and below. Such an axis is marked `upright`; with one blind end that end is down, unless it is
/// the sky: where all planes across the axis face one way nothing lies overhead, and they face up. Without such an axis
/// the one whose planes lie nearest to the station goes first: floor and ceiling are nearer than most walls. Nothing is
/// assumed about the file's z.
void put_upright_first(const SampledScan& scan, std::vector<DominantAxis>& axes);

}  // namespace isthmus
