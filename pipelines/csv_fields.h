// The plain tables that people write: fields between commas, blanks around them ignored, '#' begins a comment line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace isthmus::pipelines {

struct CsvLine {
  int number = 0;  ///< in the file, from 1
  std::vector<std::string> fields;
};

/// Every line that holds something, the header's included.
std::vector<CsvLine> csv_lines(std::string_view text);

}  // namespace isthmus::pipelines
