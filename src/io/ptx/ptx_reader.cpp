#include "io/ptx/ptx_reader.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "io/line_reader.h"
#include "io/notes.h"
#include "io/text/guess_columns.h"
#include "io/text_columns.h"
#include "io/text_number.h"
#include "io/text_reader.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

struct PtxHeader {
  std::uint64_t columns = 0, rows = 0, num_lines = 0;
  Eigen::Matrix4d row_vector_pose = Eigen::Matrix4d::Identity();  // as stored: [p 1] * M
};

Result<std::vector<double>> numbers_of_next_line(LineReader& lines, const std::string& file, std::size_t count,
                                                 std::string_view what) {
  std::string_view line;
  auto got = lines.next(line);
  if (!got) return tl::unexpected(std::move(got.error()));
  const std::string where = at_line(file, lines.number() + (*got ? 0 : 1));
  if (!*got)
    return fail(fmt::format("the file ends inside a PTX header, before {}", what), where, "the file is cut short");
  std::vector<double> numbers;
  for (const auto word : words_of(line)) {
    const auto number = whole_number<double>(word);
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
  }
  if (numbers.size() != count || words_of(line).size() != count) {
    return fail(fmt::format("PTX header: {} expected, not {}", what, in_quotes(line)), where);
  }
  return numbers;
}

Result<std::uint64_t> count_of_next_line(LineReader& lines, const std::string& file, std::string_view what) {
  auto numbers = numbers_of_next_line(lines, file, 1, what);
  if (!numbers) return tl::unexpected(std::move(numbers.error()));
  constexpr double kMost = 4294967296.0;
  const double value = numbers->front();
  if (value < 0.0 || value != std::floor(value) || value > kMost) {
    return fail(fmt::format("PTX header: {} cannot be {}", what, value), at_line(file, lines.number()));
  }
  return static_cast<std::uint64_t>(value);
}

Result<PtxHeader> read_header(LineReader& lines, const std::string& file) {
  PtxHeader ptx;
  for (auto [count, what] :
       {std::pair{&ptx.columns, "the number of columns"}, std::pair{&ptx.rows, "the number of rows"}}) {
    auto read = count_of_next_line(lines, file, what);
    if (!read) return tl::unexpected(std::move(read.error()));
    *count = *read;
  }
  if (ptx.rows != 0 && ptx.columns > std::numeric_limits<std::uint64_t>::max() / ptx.rows) {
    return fail("PTX header: columns times rows overflows", at_line(file, lines.number()));
  }
  ptx.num_lines = ptx.columns * ptx.rows;
  for (const char* what : {"the scanner's position", "an axis", "an axis", "an axis"}) {
    auto read = numbers_of_next_line(lines, file, 3, what);
    if (!read) return tl::unexpected(std::move(read.error()));
  }
  for (int row = 0; row < 4; ++row) {
    auto read = numbers_of_next_line(lines, file, 4, "a row of the 4x4 matrix");
    if (!read) return tl::unexpected(std::move(read.error()));
    for (int column = 0; column < 4; ++column)
      ptx.row_vector_pose(row, column) = (*read)[static_cast<std::size_t>(column)];
  }
  return ptx;
}

// Rigid within what six printed digits allow; then the nearest rotation.
std::optional<Transform> rigid(const Eigen::Matrix4d& row_vector_pose) {
  constexpr double kTolerance = 1e-3;
  const Eigen::Matrix4d m = row_vector_pose.transpose();
  const Eigen::Matrix3d rotation = m.topLeftCorner<3, 3>();
  const bool orthonormal = (rotation * rotation.transpose()).isIdentity(kTolerance) && rotation.determinant() > 0.0;
  if (!orthonormal || !m.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kTolerance)) return std::nullopt;
  Transform pose = Transform::Identity();
  pose.linear() = rotation;
  pose.translation() = m.topRightCorner<3, 1>();
  return orthonormalised(pose);
}

// Moves over empty lines; false at the end of the file.
Result<bool> at_next_content(InputFile& file, LineReader& lines) {
  for (;;) {
    const std::uint64_t place = file.offset();
    const LineReader before = lines;
    std::string_view line;
    auto got = lines.next(line);
    if (!got || !*got) return got;
    if (trimmed(line).empty()) continue;
    file.seek(place);
    lines = before;
    return true;
  }
}

}  // namespace

Result<std::vector<ScanRef>> scans_of_ptx(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  std::vector<ScanRef> scans;
  LineReader lines(*file);
  for (;;) {
    auto content = at_next_content(*file, lines);
    if (!content && scans.empty()) return tl::unexpected(std::move(content.error()));
    if (content && !*content) break;
    ScanRef scan = {path, static_cast<int>(scans.size()), {}, {file->offset(), file->size(), lines.number() + 1}};
    auto ptx = read_header(lines, file->name());
    auto skipped = ptx ? lines.skip(ptx->num_lines) : Result<std::uint64_t>(0);
    const bool whole = ptx && skipped && *skipped == ptx->num_lines;
    if (whole) scan.place.end_byte = file->offset();
    scans.push_back(std::move(scan));
    if (!whole) break;  // opening this entry says what is wrong
  }
  if (scans.empty()) return fail("the file holds no scan", path.string());
  return scans;
}

OpenedScan open_ptx(const ScanRef& scan) {
  FilePlace place = scan.place;
  if (place.end_byte == 0) {
    auto scans = scans_of_ptx(scan.path);
    if (!scans) return tl::unexpected(std::move(scans.error()));
    if (scan.index < 0 || static_cast<std::size_t>(scan.index) >= scans->size()) {
      return fail(fmt::format("the file holds {} scans, there is no #{}", scans->size(), scan.index),
                  scan.path.string(), "scans are counted from 0");
    }
    place = (*scans)[static_cast<std::size_t>(scan.index)].place;
  }
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  file->seek(place.first_byte);
  LineReader lines(*file, place.first_line);
  auto ptx = read_header(lines, file->name());
  if (!ptx) return tl::unexpected(std::move(ptx.error()));
  if (ptx->num_lines == 0) return fail("the scan holds no points", at_line(file->name(), place.first_line));
  TextBlock block = {file->offset(), lines.number() + 1, place.end_byte, true, ptx->num_lines, true, true};
  auto sample = sample_of_lines(*file, block.begin_line, block.end_byte);
  if (!sample) return tl::unexpected(std::move(sample.error()));
  const GuessedColumns guess = guess_columns(*sample, ' ');
  ScanHeader header;
  header.format = "ptx";
  header.num_points = ptx->num_lines;
  header.has_intensity = guess.columns.has(FieldRole::intensity);
  header.has_colour = guess.columns.has_colour();
  header.file_from_scan = rigid(ptx->row_vector_pose);
  header.notes.push_back(fmt::format("{}{} columns and {} rows; {}", kGridNote, ptx->columns, ptx->rows, guess.note));
  if (!header.file_from_scan) header.notes.push_back("the stored 4x4 matrix is not rigid: no pose taken");
  return open_text(std::move(*file), std::move(header), column_parser(guess.columns), block);
}

}  // namespace isthmus::io
