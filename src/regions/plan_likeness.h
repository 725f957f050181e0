// How well one ground plan can be laid on another: what tells scans of one place from others, without a descriptor.
#pragma once

#include "regions/ground_plan.h"

namespace isthmus {

/// How much more the likeliest way to lay the source's plan on the target's explains than the likeliest elsewhere. A
/// way is scored by the columns that it finds where the target has columns that face the same way and begin or end at
/// the same height: each counts the logarithm of the inverse chance to meet one anywhere at that density, times how
/// rare its facing is nearby; columns that meet nothing cost nothing, since most of a scan is not shared. Ways come
/// from Hough voting (ShiftVotes). 0 where a plan has fewer than eight columns or nothing meets; columns farther than
/// 300 cells from the middle do not count. Both plans z up and about their middles; how they are turned does not
/// matter. Deterministic; some milliseconds.
float plan_likeness(const GroundPlan& source, const GroundPlan& target);

/// The plan of the same scan with the other end of its vertical up.
GroundPlan upside_down(GroundPlan plan);

}  // namespace isthmus
