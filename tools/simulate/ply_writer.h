// Binary little-endian PLY: float x y z intensity.
#pragma once

#include <filesystem>

#include "base/error.h"
#include "io/scan_reader.h"

namespace isthmus::sim {

Result<void> write_ply(const std::filesystem::path& path, const io::PointChunk& points);

}  // namespace isthmus::sim
