#include "io/ply/ply_reader.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <utility>

#include "io/line_reader.h"
#include "io/ply/ply_list_reader.h"
#include "io/record_reader.h"
#include "io/text_columns.h"
#include "io/text_number.h"
#include "io/text_reader.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

// Roles of the vertex properties; lists have none.
std::vector<FieldRole> roles_of(const PlyElement& vertex) {
  std::vector<FieldRole> roles;
  for (const PlyProperty& property : vertex.properties) {
    FieldRole role = property.list_count_type ? FieldRole::other : role_of_field(property.name);
    if (role == FieldRole::packed_rgb) role = FieldRole::other;
    const bool taken = std::find(roles.begin(), roles.end(), role) != roles.end();
    roles.push_back(taken ? FieldRole::other : role);
  }
  return roles;
}

double colour_scale_of(const PlyElement& vertex) {
  for (const PlyProperty& property : vertex.properties) {
    if (role_of_field(property.name) != FieldRole::red) continue;
    if (property.type == ScalarType::float32 || property.type == ScalarType::float64) return 255.0;
    if (property.type == ScalarType::uint16) return 255.0 / 65535.0;
  }
  return 1.0;
}

// A vertex line whose lists shift the columns behind them.
LineParser list_line_parser(const PlyElement& vertex, const TextColumns& columns) {
  return [properties = vertex.properties, parse = column_parser(columns)](std::string_view line, TextPoint& point) {
    if (is_comment_or_empty(line)) return LineKind::skipped;
    const auto words = words_of(line);
    std::string scalars;
    std::size_t w = 0;
    for (const PlyProperty& property : properties) {
      if (w >= words.size()) return LineKind::bad;
      if (property.list_count_type) {
        const auto length = whole_number<std::uint32_t>(words[w]);
        if (!length || *length > words.size()) return LineKind::bad;
        w += *length + 1;
        scalars += "0 ";  // a place for the list's column, which has no role
      } else {
        scalars.append(words[w++]) += ' ';
      }
    }
    return parse(scalars, point);
  };
}

Result<void> skip_lines(InputFile& file, const PlyHeader& ply, std::uint64_t& line) {
  LineReader lines(file, ply.data_line);
  for (std::size_t e = 0; e < ply.vertex; ++e) {
    auto skipped = lines.skip(ply.elements[e].count);
    if (!skipped) return tl::unexpected(std::move(skipped.error()));
    if (*skipped < ply.elements[e].count) {
      return fail(fmt::format("the header says {} elements '{}', the file holds {}", ply.elements[e].count,
                              ply.elements[e].name, *skipped),
                  at_line(file.name(), lines.number()), "the file is cut short: export it again");
    }
  }
  line = lines.number() + 1;
  return {};
}

OpenedScan open_ascii(InputFile file, ScanHeader header, const PlyHeader& ply) {
  const PlyElement& vertex = ply.elements[ply.vertex];
  TextBlock block;
  if (auto skipped = skip_lines(file, ply, block.begin_line); !skipped) {
    return tl::unexpected(std::move(skipped.error()));
  }
  block.begin_byte = file.offset();
  block.end_byte = file.size();
  block.num_lines = vertex.count;
  for (std::size_t e = ply.vertex + 1; e < ply.elements.size(); ++e) block.only_points &= ply.elements[e].count == 0;
  TextColumns columns;
  columns.roles = roles_of(vertex);
  columns.colour_scale = colour_scale_of(vertex);
  header.num_points = vertex.count;
  header.has_intensity = columns.has(FieldRole::intensity);
  header.has_colour = columns.has_colour();
  LineParser parser = vertex.has_lists() ? list_line_parser(vertex, columns) : column_parser(columns);
  return open_text(std::move(file), std::move(header), std::move(parser), block);
}

OpenedScan open_binary(InputFile file, ScanHeader header, const PlyHeader& ply) {
  const bool file_is_little = ply.encoding == PlyHeader::Encoding::little_endian;
  const bool swap_bytes = file_is_little != (std::endian::native == std::endian::little);
  for (std::size_t e = 0; e < ply.vertex; ++e) {
    if (auto skipped = skip_ply_elements(file, ply.elements[e], swap_bytes); !skipped) {
      return tl::unexpected(std::move(skipped.error()));
    }
  }
  const PlyElement& vertex = ply.elements[ply.vertex];
  header.num_points = vertex.count;
  if (vertex.has_lists()) return open_ply_list_vertices(std::move(file), std::move(header), vertex, swap_bytes);
  const RecordBlock block = {file.offset(), vertex.count};
  return open_records(std::move(file), std::move(header), ply_vertex_layout(vertex, swap_bytes), block);
}

}  // namespace

RecordLayout ply_vertex_layout(const PlyElement& vertex, bool swap_bytes) {
  RecordLayout layout;
  layout.bytes_per_record = static_cast<std::size_t>(vertex.fixed_bytes());
  layout.swap_bytes = swap_bytes;
  std::array<std::optional<RecordField>, 9> field_of_role;
  const auto roles = roles_of(vertex);
  std::size_t offset = 0;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    const ScalarType type = vertex.properties[i].type;
    field_of_role[static_cast<std::size_t>(roles[i])] = RecordField{type, offset, layout.bytes_per_record, 1.0, 0.0};
    offset += bytes_of(type);
  }
  const auto field = [&](FieldRole role) { return field_of_role[static_cast<std::size_t>(role)]; };
  layout.x = *field(FieldRole::x);
  layout.y = *field(FieldRole::y);
  layout.z = field(FieldRole::z);
  layout.intensity = field(FieldRole::intensity);
  if (field(FieldRole::red) && field(FieldRole::green) && field(FieldRole::blue)) {
    layout.colour = {*field(FieldRole::red), *field(FieldRole::green), *field(FieldRole::blue)};
  }
  return layout;
}

OpenedScan open_ply(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto ply = read_ply_header(*file);
  if (!ply) return tl::unexpected(std::move(ply.error()));
  const PlyElement& vertex = ply->elements[ply->vertex];
  if (vertex.count == 0) return fail("the file holds no points", file->name());
  ScanHeader header;
  header.format = "ply";
  header.notes = ply->notes;
  const auto roles = roles_of(vertex);
  if (std::find(roles.begin(), roles.end(), FieldRole::z) == roles.end()) {
    header.notes.push_back("no property z: taken as 0");
  }
  file->seek(ply->data_begin);
  if (ply->encoding == PlyHeader::Encoding::ascii) return open_ascii(std::move(*file), std::move(header), *ply);
  return open_binary(std::move(*file), std::move(header), *ply);
}

}  // namespace isthmus::io
