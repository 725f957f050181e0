// One line of a table: which column is which value. Shared by XYZ, PTS, PTX, 3D, ascii PCD and ascii PLY.
#pragma once

#include <vector>

#include "io/field_role.h"
#include "io/text_reader.h"

namespace isthmus::io {

struct TextColumns {
  char delimiter = ' ';          ///< ' ' stands for any run of blanks and tabs
  std::vector<FieldRole> roles;  ///< one per column; columns beyond are ignored
  double colour_scale = 1.0;     ///< stored value to 0..255

  [[nodiscard]] bool has(FieldRole role) const;
  [[nodiscard]] bool has_colour() const;
};

/// Parses lines with these columns. Empty lines and lines that start with '#', '//', '%', '!' are skipped; a line that
/// lacks a wanted column or holds something else there than a number is bad.
LineParser column_parser(const TextColumns& columns);

/// The number at the start of `field` (quotes around it allowed) must be all there is in it.
bool is_number(std::string_view field);

/// Splits a line into fields by the delimiter, blanks around them removed.
std::vector<std::string_view> fields_of(std::string_view line, char delimiter);

/// True for lines without content: empty ones and comments.
bool is_comment_or_empty(std::string_view line);

}  // namespace isthmus::io
