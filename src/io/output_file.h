// A file written in pieces that appears by rename when it is whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"

namespace isthmus::io {

/// Bytes go to a temporary file beside `path`; publish() syncs it and renames it over `path`. Without publish() the
/// temporary file is removed and `path` stays as it was.
class OutputFile {
 public:
  static Result<OutputFile> create(const std::filesystem::path& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  Result<void> write(std::string_view bytes);
  /// Replaces bytes written before; what follows is appended behind the last byte as before.
  Result<void> overwrite(std::uint64_t offset, std::string_view bytes);
  Result<void> publish();

 private:
  OutputFile(int descriptor, std::filesystem::path path, std::string temporary);
  [[nodiscard]] tl::unexpected<Error> system_failure(std::string_view verb) const;

  int descriptor_ = -1;
  std::filesystem::path path_;
  std::string temporary_;
};

}  // namespace isthmus::io
