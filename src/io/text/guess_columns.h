// Which column of a table without names is what.
#pragma once

#include <string>
#include <vector>

#include "io/input_file.h"
#include "io/text_columns.h"

namespace isthmus::io {

struct GuessedColumns {
  TextColumns columns;
  std::string note;  ///< "columns x y z intensity, delimiter blank"
};

/// Lines with content (no comments) from the file's present place up to `end_byte`, at most 200 and 64 KiB; the place
/// is kept.
Result<std::vector<std::string>> sample_of_lines(InputFile& file, std::uint64_t line_number, std::uint64_t end_byte);

/// x y z first; then by count and values of the sample's columns: intensity, colours (whole numbers 0..255), normals
/// (unit length; not used). Columns are counted on the shortest line but the last, which may be cut short.
/// Precondition: at least one line.
GuessedColumns guess_columns(const std::vector<std::string>& lines, char delimiter);

/// 255 for colours of 0..1, 255/65535 for colours beyond 255, else 1. `columns` says where the colours are.
double guess_colour_scale(const std::vector<std::string>& lines, const TextColumns& columns);

/// "columns x y z - - red green blue, delimiter ','".
std::string describe(const TextColumns& columns);

}  // namespace isthmus::io
