// Lines of a text file, one at a time, with their numbers for error messages.
#pragma once

#include <cstdint>
#include <string_view>

#include "io/input_file.h"

namespace isthmus::io {

class LineReader {
 public:
  /// Reads from the file's present place, which is the start of line `next_line` (from 1).
  explicit LineReader(InputFile& file, std::uint64_t next_line = 1) : file_(&file), next_line_(next_line) {}

  /// The next line without its "\n" or "\r\n"; false at the end of the file. The view holds until the next call.
  /// A line longer than the file's buffer (1 MiB) or one that holds a zero byte is an error: this is no text file.
  Result<bool> next(std::string_view& line);

  /// Skips `count` lines of any length; returns how many there were (fewer at the end of the file).
  Result<std::uint64_t> skip(std::uint64_t count);

  [[nodiscard]] std::uint64_t number() const { return next_line_ - 1; }        ///< of the line returned last
  [[nodiscard]] std::uint64_t next_offset() const { return file_->offset(); }  ///< byte where the next line starts

 private:
  InputFile* file_;
  std::uint64_t next_line_;
};

}  // namespace isthmus::io
