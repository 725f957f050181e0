// Who stood there during one scan and not during the other.
#pragma once

#include <cstdint>
#include <span>

#include "regions/scan_model.h"

namespace isthmus {

/// How many of the `contradicted` points of a scan (distinct indices into its points: they stand where another station
/// saw through) belong to bodies of a person's size that stand free. People walk on between scans and forbid no pose;
/// walls, doors and furniture that stand in seen-through space are larger, flatter or part of something. 0 where the
/// scan's vertical is not known, its voxels are too coarse for a person, or where so much is contradicted that people
/// are no explanation.
std::size_t num_of_passers_by(const ScanModel& scan, std::span<const std::uint32_t> contradicted);

}  // namespace isthmus
