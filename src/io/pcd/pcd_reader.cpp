#include "io/pcd/pcd_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "io/line_reader.h"
#include "io/pcd/pcd_compressed.h"
#include "io/pcd/pcd_header.h"
#include "io/record_reader.h"
#include "io/text_columns.h"
#include "io/text_reader.h"

namespace isthmus::io {
namespace {

// Records as they lie in a binary file (field after field in each point) or, for compressed data, all points of one
// field after the other.
RecordLayout layout_of(const PcdHeader& pcd, bool field_by_field) {
  RecordLayout layout;
  layout.bytes_per_record = pcd.bytes_per_point();
  layout.swap_bytes = std::endian::native != std::endian::little;
  std::array<std::optional<RecordField>, 9> of_role;
  std::size_t offset = 0;
  for (const PcdField& field : pcd.fields) {
    auto& place = of_role[static_cast<std::size_t>(role_of_field(field.name))];
    const std::size_t step = field_by_field ? field.bytes() : layout.bytes_per_record;
    if (!place && field.count > 0) place = RecordField{field.type, offset, step, 1.0, 0.0};
    offset += field_by_field ? field.bytes() * static_cast<std::size_t>(pcd.num_points) : field.bytes();
  }
  const auto of = [&](FieldRole role) { return of_role[static_cast<std::size_t>(role)]; };
  layout.x = *of(FieldRole::x);
  layout.y = *of(FieldRole::y);
  layout.z = of(FieldRole::z);
  layout.intensity = of(FieldRole::intensity);
  if (of(FieldRole::red) && of(FieldRole::green) && of(FieldRole::blue)) {
    layout.colour = {*of(FieldRole::red), *of(FieldRole::green), *of(FieldRole::blue)};
  }
  const auto rgb = of(FieldRole::packed_rgb);
  if (rgb && bytes_of(rgb->type) == 4 && !layout.colour) layout.packed_rgb = rgb;
  return layout;
}

TextColumns columns_of(const PcdHeader& pcd, char delimiter) {
  TextColumns columns;
  columns.delimiter = delimiter;
  for (const PcdField& field : pcd.fields) {
    const FieldRole role = role_of_field(field.name);
    for (std::uint32_t i = 0; i < field.count; ++i) {
      const bool first = i == 0 && !columns.has(role);
      columns.roles.push_back(first ? role : FieldRole::other);
    }
  }
  return columns;
}

// PDAL writes ascii PCD with commas too.
Result<char> delimiter_of_next_line(InputFile& file) {
  const std::uint64_t place = file.offset();
  LineReader lines(file);
  std::string_view line;
  auto got = lines.next(line);
  if (!got) return tl::unexpected(std::move(got.error()));
  const bool comma = *got && line.find(',') != std::string_view::npos;
  file.seek(place);
  return comma ? ',' : ' ';
}

OpenedScan open_ascii(InputFile file, ScanHeader header, const PcdHeader& pcd) {
  auto delimiter = delimiter_of_next_line(file);
  if (!delimiter) return tl::unexpected(std::move(delimiter.error()));
  const TextColumns columns = columns_of(pcd, *delimiter);
  TextBlock block;
  block.begin_byte = pcd.data_begin;
  block.begin_line = pcd.data_line;
  block.end_byte = file.size();
  block.num_lines = pcd.num_points;
  header.has_intensity = columns.has(FieldRole::intensity);
  header.has_colour = columns.has_colour();
  return open_text(std::move(file), std::move(header), column_parser(columns), block);
}

}  // namespace

OpenedScan open_pcd(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto pcd = read_pcd_header(*file);
  if (!pcd) return tl::unexpected(std::move(pcd.error()));
  if (pcd->num_points == 0) return fail("the file holds no points", file->name());
  ScanHeader header;
  header.format = "pcd";
  header.num_points = pcd->num_points;
  header.station_in_scan = pcd->viewpoint;
  header.notes = pcd->notes;
  file->seek(pcd->data_begin);
  if (pcd->data == PcdHeader::Data::ascii) return open_ascii(std::move(*file), std::move(header), *pcd);
  if (pcd->data == PcdHeader::Data::binary) {
    return open_records(std::move(*file), std::move(header), layout_of(*pcd, false),
                        {pcd->data_begin, pcd->num_points});
  }
  auto bytes = decompress_pcd_block(*file, *pcd);
  if (!bytes) return tl::unexpected(std::move(bytes.error()));
  return open_pcd_columns(std::move(*bytes), std::move(header), layout_of(*pcd, true));
}

}  // namespace isthmus::io
