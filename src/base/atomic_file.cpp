#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "base/disk_space.h"

namespace isthmus {
namespace {

std::atomic<unsigned> temporary_counter{0};

std::string reason() { return std::strerror(errno); }

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  const std::string temporary = fmt::format("{}.tmp-{}-{}", path.string(), ::getpid(), temporary_counter.fetch_add(1));
  // What was written so far goes first, so that the error counts the space that is free without it.
  const auto give_up = [&](const char* what) -> tl::unexpected<Error> {
    const int error_number = errno;
    ::unlink(temporary.c_str());
    return tl::unexpected(write_error(what, error_number, path, content.size()));
  };
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return give_up("cannot be created");
  const auto close_and_give_up = [&](const char* what) -> tl::unexpected<Error> {
    const int error_number = errno;
    ::close(fd);
    errno = error_number;
    return give_up(what);
  };
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n = ::write(fd, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return close_and_give_up("cannot be written");
    done += static_cast<std::size_t>(n);
  }
  if (::fsync(fd) != 0) return close_and_give_up("cannot be synced");
  const bool published = ::close(fd) == 0 && ::rename(temporary.c_str(), path.c_str()) == 0;
  if (!published) return give_up("cannot be moved into place");
  return {};
}

Result<std::string> read_file(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return fail("cannot open: " + reason(), path.string());
  struct stat info {};
  std::string content;
  if (::fstat(fd, &info) == 0 && info.st_size > 0) content.reserve(static_cast<std::size_t>(info.st_size));
  char buffer[1 << 16];
  for (;;) {
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const std::string why = reason();
      ::close(fd);
      return fail("cannot read: " + why, path.string());
    }
    if (n == 0) break;
    content.append(buffer, static_cast<std::size_t>(n));
  }
  ::close(fd);
  return content;
}

}  // namespace isthmus
