#include "io/text/table_reader.h"

#include <utility>

#include "io/text/text_table.h"
#include "io/text_reader.h"

namespace isthmus::io {
namespace {

OpenedScan open_table(const ScanRef& scan, std::string format, const auto& wrap_parser) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto table = detect_table(*file);
  if (!table) return tl::unexpected(std::move(table.error()));
  if (table->problem) return tl::unexpected(std::move(*table->problem));
  ScanHeader header;
  header.format = std::move(format);
  header.num_points = table->num_lines;
  header.has_intensity = table->columns.has(FieldRole::intensity);
  header.has_colour = table->columns.has_colour();
  header.notes.push_back(table->note);
  const TextBlock block = {table->begin_byte, table->begin_line, file->size(), true, table->num_lines, false, false};
  return open_text(std::move(*file), std::move(header), wrap_parser(column_parser(table->columns)), block);
}

LineParser as_it_is(LineParser parser) { return parser; }

}  // namespace

OpenedScan open_xyz(const ScanRef& scan) { return open_table(scan, "xyz", as_it_is); }

OpenedScan open_pts(const ScanRef& scan) { return open_table(scan, "pts", as_it_is); }

OpenedScan open_3dtk(const ScanRef& scan) {
  return open_table(scan, "3dtk", [](LineParser parser) -> LineParser {
    return [parse = std::move(parser)](std::string_view line, TextPoint& point) {
      constexpr double kCentimetresPerMetre = 100.0;
      const LineKind kind = parse(line, point);
      const Eigen::Vector3d p = point.p_in_scan;
      if (kind == LineKind::point) point.p_in_scan = Eigen::Vector3d(p.z(), -p.x(), p.y()) / kCentimetresPerMetre;
      return kind;
    };
  });
}

bool may_hold_coordinates(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return true;
  auto table = detect_table(*file);
  return !table || table->has_coordinates;
}

}  // namespace isthmus::io
