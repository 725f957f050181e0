#include "io/text/guess_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/line_reader.h"
#include "io/text_number.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kSampleLines = 200;
constexpr std::uint64_t kSampleBytes = std::uint64_t{1} << 16;

using Table = std::vector<std::vector<double>>;  // a row per line; NaN where a field is no number

Table numbers_of(const std::vector<std::string>& lines, char delimiter) {
  Table table;
  for (const std::string& line : lines) {
    std::vector<double> row;
    for (const auto field : fields_of(line, delimiter)) row.push_back(whole_number<double>(field).value_or(NAN));
    table.push_back(std::move(row));
  }
  return table;
}

bool all_in(const Table& table, std::size_t first, std::size_t count, const auto& test) {
  return std::all_of(table.begin(), table.end(), [&](const std::vector<double>& row) {
    return std::all_of(row.begin() + static_cast<std::ptrdiff_t>(first),
                       row.begin() + static_cast<std::ptrdiff_t>(first + count), test);
  });
}

bool are_colours(const Table& table, std::size_t first) {
  return all_in(table, first, 3, [](double v) { return v >= 0.0 && v <= 255.0 && v == std::floor(v); });
}

bool are_normals(const Table& table, std::size_t first) {
  constexpr double kTolerance = 0.02;
  std::size_t unit = 0;
  for (const auto& row : table) {
    unit += std::abs(std::hypot(row[first], row[first + 1], row[first + 2]) - 1.0) < kTolerance ? 1 : 0;
  }
  return 2 * unit > table.size();
}

bool is_constant(const Table& table, std::size_t column) {
  return all_in(table, column, 1, [&](double v) { return v == table.front()[column]; });
}

bool is_colour(FieldRole role) { return role == FieldRole::red || role == FieldRole::green || role == FieldRole::blue; }

}  // namespace

Result<std::vector<std::string>> sample_of_lines(InputFile& file, std::uint64_t line_number, std::uint64_t end_byte) {
  const std::uint64_t place = file.offset();
  const std::uint64_t end = std::min(end_byte, place + kSampleBytes);
  LineReader lines(file, line_number);
  std::vector<std::string> sample;
  std::string_view line;
  while (sample.size() < kSampleLines && lines.next_offset() < end) {
    auto got = lines.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got) break;
    if (!is_comment_or_empty(line)) sample.emplace_back(line);
  }
  file.seek(place);
  return sample;
}

GuessedColumns guess_columns(const std::vector<std::string>& lines, char delimiter) {
  Table table = numbers_of(lines, delimiter);
  if (table.size() > 1) table.pop_back();  // the last line may be cut short
  std::size_t width = table.empty() ? 0 : table.front().size();
  for (const auto& row : table) width = std::min(width, row.size());
  GuessedColumns guess;
  guess.columns.delimiter = delimiter;
  std::vector<FieldRole> more;  // behind x y z
  const bool rgb_at_3 = width >= 6 && are_colours(table, 3), rgb_at_4 = width >= 7 && are_colours(table, 4);
  if (width >= 6 && !rgb_at_3 && !rgb_at_4 && are_normals(table, 3)) {
    guess.note = " (nx ny nz not used)";
  } else if (rgb_at_4 && !(rgb_at_3 && is_constant(table, 6))) {  // r g b and a constant alpha: not intensity r g b
    more = {FieldRole::intensity, FieldRole::red, FieldRole::green, FieldRole::blue};
  } else if (rgb_at_3) {
    more = {FieldRole::red, FieldRole::green, FieldRole::blue};
  } else if (width >= 4) {
    more = {FieldRole::intensity};
  }
  for (const FieldRole role : {FieldRole::x, FieldRole::y, FieldRole::z}) guess.columns.roles.push_back(role);
  for (const FieldRole role : more) guess.columns.roles.push_back(role);
  guess.note = describe(guess.columns) + guess.note;
  return guess;
}

double guess_colour_scale(const std::vector<std::string>& lines, const TextColumns& columns) {
  double largest = 0.0;
  for (const auto& row : numbers_of(lines, columns.delimiter)) {
    for (std::size_t c = 0; c < std::min(row.size(), columns.roles.size()); ++c) {
      if (is_colour(columns.roles[c])) largest = std::fmax(largest, row[c]);
    }
  }
  constexpr double kByte = 255.0;
  constexpr double kTwoBytes = 65535.0;
  return largest <= 1.0 ? kByte : largest > kByte ? kByte / kTwoBytes : 1.0;
}

std::string describe(const TextColumns& columns) {
  constexpr std::array kNames = {"-", "x", "y", "z", "intensity", "red", "green", "blue", "rgb"};
  std::string text = "columns";
  for (const FieldRole role : columns.roles) text.append(" ").append(kNames[static_cast<std::size_t>(role)]);
  return text + (columns.delimiter == ' ' ? std::string(", delimiter blank")
                                          : fmt::format(", delimiter '{}'", columns.delimiter));
}

}  // namespace isthmus::io
