// DATA binary_compressed of PCD files: one LZF block for all points.
#pragma once

#include "io/pcd/pcd_header.h"
#include "io/probing_reader.h"

namespace isthmus::io {

/// The decompressed block. `file` stands at the data. Sizes are checked against the file and against what LZF can
/// expand to at most before anything is allocated.
Result<std::vector<char>> decompress_pcd_block(InputFile& file, const PcdHeader& pcd);

/// Streams a decompressed block, whose size has been checked against header.num_points.
OpenedScan open_pcd_columns(std::vector<char> bytes, ScanHeader header, const RecordLayout& layout);

}  // namespace isthmus::io
