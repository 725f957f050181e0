// Writes data bytes as the pages of an E57 file (e57_pages.h).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "io/e57/e57_file.h"
#include "io/output_file.h"

namespace isthmus::io {

class E57PageWriter {
 public:
  /// Begins with room for the header of the file.
  static Result<E57PageWriter> create(const std::filesystem::path& path);

  [[nodiscard]] std::uint64_t logical() const { return page_number_ * kE57PageData + page_.size(); }

  Result<void> append(std::string_view bytes);
  /// Zero bytes up to a multiple of 4, where sections begin.
  Result<void> align();
  /// Zero bytes whose content is known later, all within one page; returns their logical offset.
  Result<std::uint64_t> reserve(std::size_t n);
  /// Writes into what was reserved.
  Result<void> fill_in(std::uint64_t logical, std::string_view bytes);

  /// Appends the XML section, writes the header; the file appears under its name.
  Result<void> publish(std::string_view xml);

 private:
  explicit E57PageWriter(OutputFile file) : file_(std::move(file)) {}
  Result<void> end_page();
  Result<void> flush();

  OutputFile file_;
  std::uint64_t page_number_ = 0;
  std::string page_;     // data of the page that is being filled
  std::string pending_;  // whole pages not yet handed to the file
  bool keep_page_ = false;
  std::map<std::uint64_t, std::string> kept_;  // data of pages that hold reserved bytes
};

}  // namespace isthmus::io
