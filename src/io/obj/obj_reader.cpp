#include "io/obj/obj_reader.h"

#include <algorithm>
#include <utility>

#include "io/line_reader.h"
#include "io/text_columns.h"
#include "io/text_number.h"
#include "io/text_reader.h"

namespace isthmus::io {
namespace {

bool is_vertex(std::string_view line) { return line.size() > 2 && line[0] == 'v' && is_blank(line[1]); }

std::string_view without_indent(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  return line;
}

LineParser vertex_parser(const TextColumns& columns) {
  return [parse = column_parser(columns)](std::string_view line, TextPoint& point) {
    line = without_indent(line);
    return is_vertex(line) ? parse(line.substr(2), point) : LineKind::skipped;
  };
}

// Six numbers are a colour (of 0..1 if all are), four a weight.
Result<TextColumns> columns_of_first_vertex(InputFile& file) {
  TextColumns columns;
  columns.roles = {FieldRole::x, FieldRole::y, FieldRole::z};
  LineReader lines(file);
  for (std::string_view line;;) {
    auto got = lines.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got) break;
    line = without_indent(line);
    if (!is_vertex(line)) continue;
    const auto words = words_of(line.substr(2));
    if (words.size() < 6) break;
    columns.roles.insert(columns.roles.end(), {FieldRole::red, FieldRole::green, FieldRole::blue});
    const bool unit = std::all_of(words.begin() + 3, words.begin() + 6,
                                  [](auto word) { return whole_number<double>(word).value_or(2.0) <= 1.0; });
    columns.colour_scale = unit ? 255.0 : 1.0;
    break;
  }
  return columns;
}

}  // namespace

OpenedScan open_obj(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto columns = columns_of_first_vertex(*file);
  if (!columns) return tl::unexpected(std::move(columns.error()));
  ScanHeader header;
  header.format = "obj";
  header.has_colour = columns->has_colour();
  TextBlock block;
  block.end_byte = file->size();
  return open_text(std::move(*file), std::move(header), vertex_parser(*columns), block);
}

}  // namespace isthmus::io
