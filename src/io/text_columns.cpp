#include "io/text_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/text_number.h"

namespace isthmus::io {
namespace {

bool is_colour(FieldRole role) { return role == FieldRole::red || role == FieldRole::green || role == FieldRole::blue; }

void put(FieldRole role, double value, double colour_scale, TextPoint& point) {
  switch (role) {
    case FieldRole::x:
      point.p_in_scan.x() = value;
      break;
    case FieldRole::y:
      point.p_in_scan.y() = value;
      break;
    case FieldRole::z:
      point.p_in_scan.z() = value;
      break;
    case FieldRole::intensity:
      point.intensity = static_cast<float>(value);
      break;
    case FieldRole::red:
    case FieldRole::green:
    case FieldRole::blue: {
      const double scaled = value * colour_scale + 0.5;
      point.colour[static_cast<std::size_t>(role) - static_cast<std::size_t>(FieldRole::red)] =
          static_cast<std::uint8_t>(scaled >= 0.0 ? std::min(scaled, 255.0) : 0.0);
      break;
    }
    case FieldRole::packed_rgb: {  // PCL writes the colour's bits as a float, or as the integer they are
      const bool whole = value >= 1.0 && value == std::floor(value) && value <= 4294967295.0;
      const auto bits =
          whole ? static_cast<std::uint32_t>(value) : std::bit_cast<std::uint32_t>(static_cast<float>(value));
      point.colour = {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
                      static_cast<std::uint8_t>(bits)};
      break;
    }
    case FieldRole::other:
      break;
  }
}

class ColumnParser {
 public:
  explicit ColumnParser(const TextColumns& columns) : columns_(columns) {
    while (!columns_.roles.empty() && columns_.roles.back() == FieldRole::other) columns_.roles.pop_back();
  }

  LineKind operator()(std::string_view line, TextPoint& point) const {
    const char* place = line.data();
    const char* const end = place + line.size();
    if (is_comment_or_empty(line)) return LineKind::skipped;
    point.p_in_scan.z() = 0.0;
    for (std::size_t column = 0; column < columns_.roles.size(); ++column) {
      if (column > 0 && !to_next_field(place, end)) return LineKind::bad;
      const FieldRole role = columns_.roles[column];
      place = skip_blanks(place, end);
      if (role == FieldRole::other) {
        skip_field(place, end);
        continue;
      }
      if (place != end && *place == '"') ++place;
      double value = 0.0;
      const char* behind = parse_number(place, end, value);
      if (behind == nullptr) return LineKind::bad;
      if (behind != end && *behind == '"') ++behind;
      if (behind != end && *behind != columns_.delimiter && !is_blank(*behind)) return LineKind::bad;
      place = behind;
      put(role, value, columns_.colour_scale, point);
    }
    return LineKind::point;
  }

 private:
  bool to_next_field(const char*& place, const char* end) const {
    place = skip_blanks(place, end);
    if (columns_.delimiter == ' ') return place != end;
    if (place == end || *place != columns_.delimiter) return false;
    ++place;
    return true;
  }
  void skip_field(const char*& place, const char* end) const {
    const bool blanks_end_it = columns_.delimiter == ' ';
    while (place != end && *place != columns_.delimiter && !(blanks_end_it && is_blank(*place))) ++place;
  }

  TextColumns columns_;
};

}  // namespace

bool TextColumns::has(FieldRole role) const { return std::find(roles.begin(), roles.end(), role) != roles.end(); }

bool TextColumns::has_colour() const {
  return std::any_of(roles.begin(), roles.end(), is_colour) || has(FieldRole::packed_rgb);
}

LineParser column_parser(const TextColumns& columns) { return ColumnParser(columns); }

bool is_number(std::string_view field) {
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
  return whole_number<double>(trimmed(field)).has_value();
}

std::vector<std::string_view> fields_of(std::string_view line, char delimiter) {
  if (delimiter == ' ') return words_of(line);
  std::vector<std::string_view> fields;
  for (std::size_t place = 0;;) {
    const std::size_t end = std::min(line.find(delimiter, place), line.size());
    fields.push_back(trimmed(line.substr(place, end - place)));
    if (end == line.size()) return fields;
    place = end + 1;
  }
}

bool is_comment_or_empty(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '#' || line.front() == '%' || line.front() == '!' || line.starts_with("//");
}

}  // namespace isthmus::io
