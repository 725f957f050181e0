#include "report/csv.h"

#include <fmt/format.h>
#include <cmath>

namespace isthmus::report {

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

CsvTable& CsvTable::add(std::string_view field) {
  if (!first_) text_ += ',';
  first_ = false;
  text_ += csv_field(field);
  return *this;
}

CsvTable& CsvTable::add(double value) {
  return std::isfinite(value) ? add(fmt::format("{:.9g}", value + 0.0)) : skip();
}

// Adding zero turns -0 into 0: the sign of nothing must not show in a diff.
CsvTable& CsvTable::add_exact(double value) {
  return std::isfinite(value) ? add(fmt::format("{}", value + 0.0)) : skip();
}

CsvTable& CsvTable::add(long long value) { return add(fmt::format("{}", value)); }

void CsvTable::end_row() {
  text_ += '\n';
  first_ = true;
}

}  // namespace isthmus::report
