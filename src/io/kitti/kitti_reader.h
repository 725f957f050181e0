// KITTI Velodyne scans (.bin): float32 x y z reflectance, little endian, nothing else. Frame of the sensor, metres.
// Source: Geiger, Lenz, Stiller, Urtasun, "Vision meets robotics: the KITTI dataset", IJRR 2013.
#pragma once

#include "io/probing_reader.h"

namespace isthmus::io {

/// A length that is no multiple of 16 is an error, and so is content that cannot be coordinates (many other kinds of
/// files end in .bin).
OpenedScan open_kitti(const ScanRef& scan);

}  // namespace isthmus::io
