// How the points of a LAZ file lie in its chunks, checked against the file before LASzip sees it.
#pragma once

#include "io/las/las_header.h"

namespace isthmus::io {

struct LazChunks {
  std::uint64_t count = 1;             ///< 1 for files of old LASzips, which know no chunks
  std::uint64_t points_per_chunk = 0;  ///< all points if there is one chunk; 0 if it varies
};

/// Fails where LASzip's record is missing or does not describe the header's points, where the table of chunks is
/// missing, or cannot hold the header's points: LASzip itself trusts them.
Result<LazChunks> read_laz_chunks(const InputFile& file, const LasHeader& las);

}  // namespace isthmus::io
