// A regular file read front to back through one buffer, or at any offset. Memory: the buffer, which no file's size
// makes larger than kBufferBytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace isthmus::io {

class InputFile {
 public:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

  /// Fails if the path is missing, unreadable, empty, or no regular file (a pipe would hang).
  static Result<InputFile> open(const std::filesystem::path& path);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  ~InputFile();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t offset() const { return buffer_offset_ + begin_; }  ///< of the next unread byte
  void seek(std::uint64_t offset);

  /// All buffered unread bytes: at least n of them, or all that the file still holds. Valid until the next call.
  /// Precondition: n <= kBufferBytes.
  Result<std::string_view> peek(std::size_t n);
  void consume(std::size_t n) { begin_ += n; }  ///< n <= what peek returned

  /// Exactly n bytes from `offset`, without moving the reading place; an error if the file ends before.
  Result<void> read_at(std::uint64_t offset, void* out, std::size_t n) const;

 private:
  InputFile(int descriptor, std::string name, std::uint64_t size);
  Result<std::size_t> read_some(std::uint64_t offset, char* out, std::size_t n) const;

  int descriptor_ = -1;
  std::string name_;
  std::uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::uint64_t buffer_offset_ = 0;  // file offset of buffer_[0]
  std::size_t begin_ = 0;            // unread bytes are buffer_[begin_, end_)
  std::size_t end_ = 0;
};

}  // namespace isthmus::io
