// A glance at a pair: is it worth a registration? For surveys with more pairs than a night can register.
#pragma once

#include <optional>

#include "regions/scan_model.h"

namespace isthmus {

/// How promising the pair is: the best score that a few column votes about the scans' common axis reach once grown
/// (ranking_score(): support less contradiction, about -5 to 1.25; a right pose has about its overlap). A tenth of
/// the work of register_pair(). Absent where nothing stands upright or no axis is known: that says nothing against the
/// pair. Models at the coarse level. Deterministic.
std::optional<double> screen_pair(const ScanModel& source, const ScanModel& target);

}  // namespace isthmus
