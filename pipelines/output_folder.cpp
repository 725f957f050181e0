#include "pipelines/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "base/disk_space.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr off_t kOwnerBytes = 64;  // who holds the lock, at the start of the file; the reserved space lies behind

fs::path lock_of(const fs::path& folder) { return folder / ".lock"; }

/// The line the owner wrote: "process 1234 on host".
std::string owner_in(int descriptor) {
  std::array<char, kOwnerBytes> text{};
  const ssize_t n = ::pread(descriptor, text.data(), text.size(), 0);
  const std::string all(text.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  return all.substr(0, all.find('\n'));
}

void write_owner(int descriptor) {
  std::array<char, kOwnerBytes> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {'?'};
  const std::string text = fmt::format("process {} on {}", ::getpid(), host.data()).substr(0, kOwnerBytes - 1) + "\n";
  // Only for the message of another run: the lock holds without it.
  [[maybe_unused]] const bool named =
      ::ftruncate(descriptor, 0) == 0 && ::pwrite(descriptor, text.data(), text.size(), 0) >= 0;
}

/// Whether the path still leads to the open file: its last owner removes it before letting go.
bool is_still_there(int descriptor, const fs::path& path) {
  struct stat open_file {
  }, named_file{};
  return ::fstat(descriptor, &open_file) == 0 && ::stat(path.c_str(), &named_file) == 0 &&
         open_file.st_ino == named_file.st_ino && open_file.st_dev == named_file.st_dev;
}

/// A descriptor that holds the lock. File systems that know no locks are trusted.
Result<int> take_lock(const fs::path& folder) {
  const fs::path path = lock_of(folder);
  for (;;) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) return tl::unexpected(write_error("the output cannot be written", errno, folder));
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::string owner = owner_in(descriptor);
      ::close(descriptor);
      return fail("another run writes to this folder" + (owner.empty() ? owner : ": " + owner), folder.string(),
                  "wait for its end or choose another output folder");
    }
    if (is_still_there(descriptor, path)) return descriptor;
    ::close(descriptor);
  }
}

}  // namespace

Result<OutputFolder> OutputFolder::open(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return fail("the output is a file, a folder is wanted", folder.string(), "name another folder with -o");
  }
  error.clear();
  const bool created = fs::create_directories(folder, error);
  if (error) return tl::unexpected(write_error("the output folder cannot be created", error.value(), folder));
  const Result<int> descriptor = take_lock(folder);
  if (!descriptor) {
    if (created) fs::remove(folder, error);
    return tl::unexpected(descriptor.error());
  }
  write_owner(*descriptor);
  return OutputFolder(folder, created, *descriptor);
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)), created_(other.created_), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFolder::~OutputFolder() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  fs::remove(lock_of(folder_), ignored);
  ::close(descriptor_);
  if (created_) fs::remove(folder_, ignored);  // not if there is something in it
}

Result<void> OutputFolder::reserve(std::uint64_t bytes) {
  const int refused = ::posix_fallocate(descriptor_, kOwnerBytes, static_cast<off_t>(bytes));
  if (refused == 0) return {};
  give_back();
  if (refused != ENOSPC && refused != EDQUOT && refused != EFBIG) return {};  // this file system cannot promise space
  return tl::unexpected(write_error("there is no space for the results", refused, folder_, bytes));
}

void OutputFolder::give_back() { [[maybe_unused]] const int refused = ::ftruncate(descriptor_, kOwnerBytes); }

}  // namespace isthmus::pipelines
