// What a text file with a point per line looks like: delimiter, columns, lines before the first point.
//
//   [comments: # // % !]  [count]  [header line with names, or a title]  then lines x y z ... separated by blanks , ;
//   or |
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/input_file.h"
#include "io/text_columns.h"

namespace isthmus::io {

struct TextTable {
  TextColumns columns;
  std::uint64_t begin_byte = 0, begin_line = 1;  ///< of the first line with a point
  std::optional<std::uint64_t> num_lines;        ///< a count line before the points
  std::string note;                              ///< what was detected
  /// Not a file of points at all (prose, a table of other things): such a .txt or .csv in a folder is no scan.
  bool has_coordinates = true;
  std::optional<Error> problem;  ///< why it cannot be read, if so
};

/// Looks at the first lines only. The error of the Result is one of the file itself.
Result<TextTable> detect_table(InputFile& file);

}  // namespace isthmus::io
