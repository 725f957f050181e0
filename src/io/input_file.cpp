#include "io/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "io/wording.h"

namespace isthmus::io {

InputFile::InputFile(int descriptor, std::string name, std::uint64_t size)
    : descriptor_(descriptor), name_(std::move(name)), size_(size) {}

InputFile::InputFile(InputFile&& other) noexcept { *this = std::move(other); }

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(name_, other.name_);
  std::swap(size_, other.size_);
  std::swap(buffer_, other.buffer_);
  std::swap(buffer_offset_, other.buffer_offset_);
  std::swap(begin_, other.begin_);
  std::swap(end_, other.end_);
  return *this;
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<InputFile> InputFile::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return fail(std::string("cannot be opened: ") + std::strerror(errno), path.string());
  struct stat status = {};
  const bool known = ::fstat(descriptor, &status) == 0;
  InputFile file(descriptor, path.string(), known ? static_cast<std::uint64_t>(status.st_size) : 0);
  if (!known || !S_ISREG(status.st_mode)) return fail("is not a regular file", path.string());
  if (file.size_ == 0) return fail("the file is empty", path.string());
  return file;
}

void InputFile::seek(std::uint64_t offset) {
  if (offset >= buffer_offset_ && offset <= buffer_offset_ + end_) {
    begin_ = static_cast<std::size_t>(offset - buffer_offset_);
    return;
  }
  buffer_offset_ = offset;
  begin_ = end_ = 0;
}

Result<std::size_t> InputFile::read_some(std::uint64_t offset, char* out, std::size_t n) const {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = ::pread(descriptor_, out + done, n - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(std::string("cannot be read: ") + std::strerror(errno), at_byte(name_, offset + done));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Result<std::string_view> InputFile::peek(std::size_t n) {
  if (end_ - begin_ < n) {
    if (buffer_.empty()) buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, size_)));
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    buffer_offset_ += begin_;
    end_ -= begin_;
    begin_ = 0;
    auto got = read_some(buffer_offset_ + end_, buffer_.data() + end_, buffer_.size() - end_);
    if (!got) return tl::unexpected(std::move(got.error()));
    end_ += *got;
  }
  return std::string_view(buffer_.data() + begin_, end_ - begin_);
}

Result<void> InputFile::read_at(std::uint64_t offset, void* out, std::size_t n) const {
  auto got = read_some(offset, static_cast<char*>(out), n);
  if (!got) return tl::unexpected(std::move(got.error()));
  if (*got < n)
    return fail(fmt::format("the file ends, {} more bytes were expected", n - *got), at_byte(name_, offset + *got));
  return {};
}

}  // namespace isthmus::io
