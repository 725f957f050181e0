// Compressed LAS (LAZ), through LASzip where the build has it: laz_points.cpp and laz_stream.cpp, else no_laz.cpp.
//
// A LAZ file is a LAS file whose variable length records hold one of user "laszip encoded", id 22204 (payload, little
// endian: 0 uint16 compressor, 2 uint16 coder, 12 int32 points per chunk, -1 = it varies, 32 uint16 number of items,
// from 34 on per item uint16 type, size, version) and whose points are, from the header's offset on: int64 place of the
// table of chunks, chunks, table (uint32 version 0, uint32 number of chunks, compressed sizes). -1 as the place says
// that it stands in the last 8 bytes of the file. Source: LASzip 3.5 (laszip.hpp, lasreadpoint.cpp, laszip_dll.cpp).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "io/las/las_header.h"
#include "io/output_file.h"
#include "io/probing_reader.h"

namespace isthmus::io {

/// Whether this build reads and writes LAZ.
bool has_laz();

/// The record of LASzip and the table of chunks are checked before LASzip sees the file. Memory: a chunk.
OpenedScan open_laz(InputFile file, const LasHeader& las);

/// Compresses records of one point format into a file. The same records give the same bytes.
class LazStream {
 public:
  /// `format`: 0, 2, 6 or 7. The file's header comes first, with record() among its variable length records, then the
  /// points, then end(); the file must outlive the stream and stay where it is.
  static Result<std::unique_ptr<LazStream>> create(OutputFile& file, unsigned format, std::size_t record_bytes,
                                                   const std::string& name);
  virtual ~LazStream() = default;
  /// The variable length record that says how the points are compressed, its own header included.
  [[nodiscard]] virtual const std::string& record() const = 0;
  /// The header with its records has been written and `points_begin` bytes long.
  virtual Result<void> begin_points(std::uint64_t points_begin) = 0;
  virtual Result<void> add(std::string_view record) = 0;
  /// Writes what is left and the table of chunks.
  virtual Result<void> end() = 0;
};

}  // namespace isthmus::io
