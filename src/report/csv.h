// Comma-separated values as in RFC 4180: CRLF is allowed but LF is what surveyors' tools expect; fields with commas,
// quotes or line breaks are quoted, quotes doubled.
#pragma once

#include <string>
#include <string_view>

namespace isthmus::report {

std::string csv_field(std::string_view text);

/// Appends one row at a time.
class CsvTable {
 public:
  CsvTable& add(std::string_view field);
  CsvTable& add(const char* field) { return add(std::string_view(field)); }
  CsvTable& add(double value);        ///< 9 significant digits; empty if not finite
  CsvTable& add_exact(double value);  ///< shortest text that reads back as the same number
  CsvTable& add(long long value);
  CsvTable& add(int value) { return add(static_cast<long long>(value)); }
  CsvTable& skip() { return add(std::string_view()); }
  void end_row();
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool first_ = true;
};

}  // namespace isthmus::report
