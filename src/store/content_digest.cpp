#include "store/content_digest.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <vector>

#include "base/digest.h"

namespace isthmus::store {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
constexpr std::int64_t kSettledSeconds = 2;  // coarser than the clock of any file system in use (FAT: 2 s)

struct Remembered {
  std::array<std::int64_t, 5> identity{};  ///< size, modification seconds, nanoseconds, inode, device
  std::string digest;
  template <class F>
  void fields(F&& f) {
    f(identity), f(digest);
  }
};

std::array<std::int64_t, 5> identity_of(const struct stat& info) {
  return {info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec, static_cast<std::int64_t>(info.st_ino),
          static_cast<std::int64_t>(info.st_dev)};
}

Result<std::string> digest_of_bytes(int fd, const std::string& path) {
  Digest digest;
  std::vector<char> block(kBlockBytes);
  for (;;) {
    const ssize_t n = ::read(fd, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return fail(std::string("cannot read: ") + std::strerror(errno), path);
    if (n == 0) return digest.hex();
    digest.add_bytes(block.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

Result<std::string> content_digest(const std::filesystem::path& path, const Store& store) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return fail(std::string("cannot open: ") + std::strerror(errno), path.string());
  struct stat info {};
  if (::fstat(fd, &info) != 0) {
    const std::string why = std::strerror(errno);
    ::close(fd);
    return fail("cannot look at: " + why, path.string());
  }
  const std::array<std::int64_t, 5> identity = identity_of(info);
  const std::array<std::string, 1> inputs = {std::filesystem::absolute(path).lexically_normal().string()};
  const Key key = make_key("content", "1", inputs);
  if (const auto known = store.load<Remembered>(key); known && known->identity == identity) {
    ::close(fd);
    return known->digest;
  }
  Result<std::string> digest = digest_of_bytes(fd, path.string());
  ::close(fd);
  const bool settled = info.st_mtim.tv_sec + kSettledSeconds < std::time(nullptr);
  if (digest && settled) store.keep(key, Remembered{identity, *digest});
  return digest;
}

}  // namespace isthmus::store
