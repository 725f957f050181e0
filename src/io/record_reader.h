// Streams fixed-size binary records from a file: the body of PLY, PCD, LAS and KITTI readers.
#pragma once

#include "io/input_file.h"
#include "io/probing_reader.h"
#include "io/record_layout.h"

namespace isthmus::io {

/// The part of a file that holds the records.
struct RecordBlock {
  std::uint64_t begin_byte = 0;
  std::uint64_t num_records = 0;
};

/// Checks the claimed number of records against the file's size ("the header says N points, the file holds M"), looks
/// at a few records to choose local origin and colour scale, and returns a reader. `header` comes with format, counts
/// and station filled in.
OpenedScan open_records(InputFile file, ScanHeader header, const RecordLayout& layout, const RecordBlock& block);

/// How a claimed count that the file cannot hold reads as an error, or nothing if it fits.
Result<void> check_record_count(const InputFile& file, std::size_t bytes_per_record, const RecordBlock& block);

}  // namespace isthmus::io
