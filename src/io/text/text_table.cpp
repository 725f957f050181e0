#include "io/text/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/line_reader.h"
#include "io/notes.h"
#include "io/text/guess_columns.h"
#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::uint64_t kLongestIntroBytes = std::uint64_t{1} << 16;

using Fields = std::vector<std::string_view>;

char delimiter_of(std::string_view line) {
  for (const char delimiter : {';', ',', '|'}) {
    if (line.find(delimiter) != std::string_view::npos) return delimiter;
  }
  return ' ';
}

std::size_t count_numbers(const Fields& fields) {
  return static_cast<std::size_t>(std::count_if(fields.begin(), fields.end(), is_number));
}

bool is_point_line(std::string_view line) {
  const Fields fields = fields_of(line, delimiter_of(line));
  return fields.size() >= 3 && is_number(fields[0]) && is_number(fields[1]) && is_number(fields[2]);
}

// "1,5;2,0;3,25": a point to a German spreadsheet.
bool has_decimal_commas(std::string_view line) {
  const Fields fields = fields_of(line, ';');
  return fields.size() >= 3 && std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
           const Fields parts = fields_of(field, ',');
           return !parts.empty() && parts.size() <= 2 && count_numbers(parts) == parts.size();
         });
}

struct Names {
  std::vector<FieldRole> roles;
  std::string listed;
  std::size_t num_known = 0;  // x, y, z among them
  bool repeated = false;      // one of x, y, z twice
  bool poses = false;         // names of rotations: a table of poses, not of points
};

Names names_of(std::string_view line) {
  Names names;
  for (const auto field : fields_of(line, delimiter_of(line))) {
    FieldRole role = role_of_field(field);
    const bool taken =
        role != FieldRole::other && std::find(names.roles.begin(), names.roles.end(), role) != names.roles.end();
    const bool coordinate = role == FieldRole::x || role == FieldRole::y || role == FieldRole::z;
    names.repeated |= taken && coordinate;
    names.num_known += coordinate && !taken ? 1 : 0;
    const std::string lower = lower_case(field);
    names.poses |= lower == "qw" || lower == "qx" || lower == "r00" || lower == "q_w" || lower == "tx";
    names.roles.push_back(taken ? FieldRole::other : role);
    if (!names.listed.empty()) names.listed += ' ';
    names.listed.append(field);
  }
  return names;
}

// The lines before the first point.
struct Intro {
  std::string names_line;  // the last line of words
  std::string comment;     // the last comment, without its mark
  std::uint64_t names_number = 0;
  bool has_prose = false;  // more than one line of words
  std::optional<std::uint64_t> count;
};

void take_intro_line(std::string_view line, std::uint64_t number, Intro& intro) {
  const std::string_view content = trimmed(line);
  if (content.empty()) return;
  if (is_comment_or_empty(content)) {
    intro.comment = std::string(content.substr(std::min(content.find_first_not_of("#/%! \t"), content.size())));
    return;
  }
  if (const auto count = whole_number<std::uint64_t>(content); count && !intro.count) {
    intro.count = count;
    return;
  }
  intro.has_prose |= !intro.names_line.empty();
  intro.names_line = std::string(line);
  intro.names_number = number;
}

void no_coordinates(TextTable& table, std::string what, std::string where) {
  table.has_coordinates = false;
  table.problem = Error{std::move(what), std::move(where), "a line with a point needs numbers x y z"};
}

// Named columns: by the header line, or by a comment that names exactly what follows (CloudCompare's "//X Y Z").
void take_names(const Intro& intro, std::size_t width, const std::string& file, TextTable& table) {
  const Names comment = names_of(intro.comment);
  const bool from_comment = intro.names_line.empty();
  const Names names = from_comment ? comment : names_of(intro.names_line);
  const std::string where = from_comment ? file : at_line(file, intro.names_number);
  if (names.poses) return no_coordinates(table, "a table of poses, not of points", where);
  if (names.num_known == 3 && (!from_comment || names.roles.size() <= width) && !names.repeated) {
    table.columns.roles = names.roles;
    return;
  }
  if (from_comment) return;
  if (names.repeated || names.num_known > 0) {
    table.problem = Error{names.repeated ? "a coordinate column is named twice: " + in_quotes(intro.names_line)
                                         : "columns x y z are not all there: " + in_quotes(names.listed),
                          where, "name the columns x y z"};
  } else if (names.roles.size() == width) {
    no_coordinates(table, "no columns x y z among " + in_quotes(names.listed), where);
  } else {
    table.note = "title line " + in_quotes(intro.names_line) + " skipped; ";
  }
}

}  // namespace

Result<TextTable> detect_table(InputFile& file) {
  LineReader lines(file);
  TextTable table;
  Intro intro;
  std::string first;  // the first line with a point
  auto head = file.peek(3);
  if (!head) return tl::unexpected(std::move(head.error()));
  if (head->starts_with("\xEF\xBB\xBF")) file.consume(3);  // byte order mark
  for (std::string_view line; first.empty();) {
    table.begin_byte = lines.next_offset();
    auto got = lines.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got || table.begin_byte > kLongestIntroBytes) break;
    if (!is_comment_or_empty(line) && has_decimal_commas(line) && !is_point_line(line)) {
      table.problem = Error{"numbers with decimal commas: " + in_quotes(line), at_line(file.name(), lines.number()),
                            "export with decimal points"};
      return table;
    }
    const bool named = names_of(intro.names_line).num_known == 3;  // then the first columns may hold anything
    if (!is_comment_or_empty(line) && (named || is_point_line(line))) first = std::string(line);
    if (first.empty()) take_intro_line(line, lines.number(), intro);
  }
  const Names names = names_of(intro.names_line);
  if (first.empty()) {
    no_coordinates(table, "no line with a point found", file.name());
    table.has_coordinates = names.num_known == 3 && !names.poses;
    return table;
  }
  table.begin_line = lines.number();
  table.num_lines = intro.count;
  file.seek(table.begin_byte);
  auto sample = sample_of_lines(file, table.begin_line, file.size());
  if (!sample) return tl::unexpected(std::move(sample.error()));
  const char delimiter = delimiter_of(first);
  GuessedColumns guess = guess_columns(*sample, delimiter);
  take_names(intro, fields_of(first, delimiter).size(), file.name(), table);
  const bool named = !table.columns.roles.empty();
  if (!named) table.columns.roles = guess.columns.roles;
  table.columns.delimiter = delimiter;
  if (named && table.columns.has_colour()) table.columns.colour_scale = guess_colour_scale(*sample, table.columns);
  table.note += named ? fmt::format("{}{}", describe(table.columns), kByNamesNote)
                      : fmt::format("{}{}", guess.note, kByValuesNote);
  return table;
}

}  // namespace isthmus::io
