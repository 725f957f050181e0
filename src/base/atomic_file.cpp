#include "base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>

namespace isthmus {
namespace {

std::atomic<unsigned> temporary_counter{0};

std::string reason() { return std::strerror(errno); }

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  const std::string temporary =
      fmt::format("{}.tmp-{}-{}", path.string(), ::getpid(), temporary_counter.fetch_add(1));
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return fail("cannot create a file: " + reason(), temporary, "check the folder's permissions and free space");
  const auto give_up = [&](const std::string& what) -> tl::unexpected<Error> {
    const std::string why = reason();
    ::close(fd);
    ::unlink(temporary.c_str());
    return fail(what + ": " + why, path.string(), "free some space or choose another output folder");
  };
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t n = ::write(fd, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return give_up("cannot write");
    done += static_cast<std::size_t>(n);
  }
  if (::fsync(fd) != 0) return give_up("cannot sync");
  if (::close(fd) != 0) {
    const std::string why = reason();
    ::unlink(temporary.c_str());
    return fail("cannot close: " + why, path.string());
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const std::string why = reason();
    ::unlink(temporary.c_str());
    return fail("cannot rename the finished file into place: " + why, path.string());
  }
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
