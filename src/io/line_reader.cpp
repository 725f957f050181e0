#include "io/line_reader.h"

#include <cstring>

#include "io/wording.h"

namespace isthmus::io {
namespace {

// Most lines are short: look at what is buffered before asking the file for more.
constexpr std::size_t kUsualLineBytes = 256;

}  // namespace

Result<bool> LineReader::next(std::string_view& line) {
  const char* end = nullptr;
  std::string_view bytes;
  for (std::size_t want = kUsualLineBytes;; want = InputFile::kBufferBytes) {
    auto got = file_->peek(want);
    if (!got) return tl::unexpected(std::move(got.error()));
    bytes = *got;
    if (bytes.empty()) return false;
    end = static_cast<const char*>(std::memchr(bytes.data(), '\n', bytes.size()));
    if (end != nullptr || bytes.size() < want) break;
    if (want == InputFile::kBufferBytes) {
      return fail("a line is longer than 1 MiB: this is no text file", at_line(file_->name(), next_line_));
    }
  }
  line = bytes.substr(0, end != nullptr ? static_cast<std::size_t>(end - bytes.data()) : bytes.size());
  file_->consume(line.size() + (end != nullptr ? 1 : 0));
  ++next_line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (std::memchr(line.data(), '\0', line.size()) != nullptr) {
    return fail("a zero byte in a text line: this is no text file", at_line(file_->name(), number()));
  }
  return true;
}

Result<std::uint64_t> LineReader::skip(std::uint64_t count) {
  std::uint64_t skipped = 0;
  bool inside = false;  // part of a line without its end has been seen
  while (skipped < count) {
    auto bytes = file_->peek(1);
    if (!bytes) return tl::unexpected(std::move(bytes.error()));
    if (bytes->empty()) break;
    std::size_t place = 0;
    while (skipped < count && place < bytes->size()) {
      const void* end = std::memchr(bytes->data() + place, '\n', bytes->size() - place);
      inside = end == nullptr;
      if (inside) {
        place = bytes->size();
      } else {
        place = static_cast<std::size_t>(static_cast<const char*>(end) - bytes->data()) + 1;
        ++skipped;
      }
    }
    file_->consume(place);
  }
  if (inside && skipped < count) ++skipped;
  next_line_ += skipped;
  return skipped;
}

}  // namespace isthmus::io
