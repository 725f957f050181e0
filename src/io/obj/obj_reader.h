// Wavefront OBJ: lines "v x y z", with "r g b" behind them as MeshLab writes; everything else is passed over.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

OpenedScan open_obj(const ScanRef& scan);

}  // namespace isthmus::io
