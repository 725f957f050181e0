#include "pipelines/scan_positions.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/atomic_file.h"
#include "io/text_number.h"
#include "pipelines/csv_fields.h"
#include "pipelines/scan_names.h"

namespace isthmus::pipelines {
namespace {

constexpr std::array<const char*, 4> kColumns = {"scan", "x", "y", "z"};
constexpr std::size_t kWithoutHeight = 3, kWithHeight = 4;  // columns there have to be

using Columns = std::array<std::size_t, kColumns.size()>;

Result<Columns> columns_of(const std::vector<std::string>& header, std::size_t num_required, const std::string& where) {
  Columns columns{};
  for (std::size_t k = 0; k < kColumns.size(); ++k) {
    columns[k] = static_cast<std::size_t>(std::ranges::find(header, kColumns[k]) - header.begin());
    if (columns[k] < header.size() || k >= num_required) continue;
    return fail(fmt::format("there is no column '{}'", kColumns[k]), where,
                "the first line names the columns: scan,x,y,z");
  }
  return columns;
}

Result<Eigen::Vector3d> position_of(const std::vector<std::string>& fields, const Columns& columns,
                                    const std::string& where) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < kColumns.size(); ++k) {
    if (columns[k] >= fields.size()) continue;  // no heights
    const std::string& text = fields[columns[k]];
    const auto number = io::whole_number<double>(text);
    if (!number || !std::isfinite(*number))
      return fail(fmt::format("'{}' under {} is not a finite number", text, kColumns[k]), where);
    position[static_cast<Eigen::Index>(k) - 1] = *number;
  }
  return position;
}

Result<ScanPositions> read(const std::string& file, std::span<const std::string> scans, std::size_t num_required) {
  ScanPositions positions;
  if (file.empty()) return positions;
  const Result<std::string> text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const std::vector<CsvLine> lines = csv_lines(*text);
  if (lines.empty()) return fail("there are no positions in it", file, "the first line names the columns: scan,x,y,z");
  const auto place = [&](const CsvLine& line) { return fmt::format("{}:{}", file, line.number); };
  const Result<Columns> columns = columns_of(lines.front().fields, num_required, place(lines.front()));
  if (!columns) return tl::unexpected(columns.error());
  for (const CsvLine& line : std::span(lines).subspan(1)) {
    if (line.fields.size() != lines.front().fields.size()) {
      return fail(fmt::format("{} fields, the first line has {}", line.fields.size(), lines.front().fields.size()),
                  place(line));
    }
    const Result<Eigen::Vector3d> position = position_of(line.fields, *columns, place(line));
    if (!position) return tl::unexpected(position.error());
    const Result<std::size_t> scan = index_of_scan(scans, line.fields[(*columns)[0]]);
    if (!scan) {
      positions.warnings.push_back(fmt::format("{}: {}; {}", place(line), scan.error().what, scan.error().hint));
      continue;
    }
    if (!positions.by_name.emplace(scans[*scan], *position).second)
      return fail(fmt::format("a second position for {}", scans[*scan]), place(line));
  }
  return positions;
}

}  // namespace

Result<ScanPositions> read_positions(const std::string& file, std::span<const std::string> scans) {
  return read(file, scans, kWithoutHeight);
}

ScanPositions positions_of_files(std::span<const std::pair<std::string, std::optional<Eigen::Vector3d>>> stored) {
  constexpr double kAtOrigin = 1e-6, kApart = 1;  // metres
  ScanPositions out;
  Eigen::AlignedBox3d box;
  const auto at_origin = [](const auto& scan) { return scan.second && scan.second->norm() < kAtOrigin; };
  const bool origin_is_none = std::ranges::count_if(stored, at_origin) > 1;
  for (const auto& scan : stored) {
    const auto& [name, position] = scan;
    if (!position || !position->allFinite() || (origin_is_none && at_origin(scan))) continue;
    out.by_name.emplace(name, *position);
    box.extend(*position);
  }
  if (box.isEmpty() || box.diagonal().norm() < kApart) return {};
  return out;
}

Result<ScanPositions> read_stations(const std::string& file, std::span<const std::string> scans) {
  return read(file, scans, kWithHeight);
}

}  // namespace isthmus::pipelines
