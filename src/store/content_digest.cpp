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
  FileIdentity identity{};
  std::string digest;
  template <class F>
  void fields(F&& f) {
    f(identity), f(digest);
  }
};

FileIdentity identity_of(const struct stat& info) {
  return {info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec, static_cast<std::int64_t>(info.st_ino)};
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

/// An open file, what identifies it, and where its digest would be.
struct OpenFile {
  int fd = -1;
  struct stat info {};
  Key key;
};

Result<OpenFile> open_file(const std::filesystem::path& path) {
  OpenFile file;
  file.fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file.fd < 0) return fail(std::string("cannot open: ") + std::strerror(errno), path.string());
  if (::fstat(file.fd, &file.info) != 0) {
    const std::string why = std::strerror(errno);
    ::close(file.fd);
    return fail("cannot look at: " + why, path.string());
  }
  const std::array<std::string, 1> inputs = {std::filesystem::absolute(path).lexically_normal().string()};
  file.key = make_key("content", "2", inputs);
  return file;
}

std::optional<std::string> remembered(const OpenFile& file, const Store& store) {
  const auto known = store.load<Remembered>(file.key);
  if (known && known->identity == identity_of(file.info)) return known->digest;
  return std::nullopt;
}

}  // namespace

Result<FileIdentity> identity_of(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) return identity_of(info);
  return fail(std::string("cannot look at: ") + std::strerror(errno), path.string());
}

Result<std::string> content_digest(const std::filesystem::path& path, const Store& store) {
  const Result<OpenFile> file = open_file(path);
  if (!file) return tl::unexpected(file.error());
  if (std::optional<std::string> known = remembered(*file, store)) {
    ::close(file->fd);
    return std::move(*known);
  }
  Result<std::string> digest = digest_of_bytes(file->fd, path.string());
  struct stat after {};
  const bool changed = ::fstat(file->fd, &after) != 0 || identity_of(after) != identity_of(file->info);
  ::close(file->fd);
  if (digest && changed) return fail("it changed while it was read", path.string(), "run again when it is complete");
  const bool settled = file->info.st_mtim.tv_sec + kSettledSeconds < std::time(nullptr);
  if (digest && settled) store.keep(file->key, Remembered{identity_of(file->info), *digest});
  return digest;
}

Result<std::optional<std::string>> remembered_digest(const std::filesystem::path& path, const Store& store) {
  const Result<OpenFile> file = open_file(path);
  if (!file) return tl::unexpected(file.error());
  ::close(file->fd);
  return remembered(*file, store);
}

}  // namespace isthmus::store
