#include "pipelines/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include "base/disk_space.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr off_t kOwnerBytes = 64;  // who holds the lock, at the start of the file; the reserved space lies behind

// A shard that begins or ends holds the lock alone for a moment; the others that begin with it try again.
constexpr int kAttempts = 40;
constexpr std::chrono::milliseconds kBetweenAttempts{50};

fs::path lock_of(const fs::path& folder) { return folder / ".lock"; }

/// The line the owner wrote: "process 1234 on host".
std::string owner_in(int descriptor) {
  std::array<char, kOwnerBytes> text{};
  const ssize_t n = ::pread(descriptor, text.data(), text.size(), 0);
  const std::string all(text.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  return all.substr(0, all.find('\n'));
}

std::string this_process() {
  std::array<char, kOwnerBytes> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {'?'};
  return fmt::format("process {} on {}", ::getpid(), host.data());
}

std::string shards_of(const std::string& plan) { return fmt::format("shards of plan {}", plan); }

void write_owner(int descriptor, const std::string& owner) {
  const std::string text = owner.substr(0, kOwnerBytes - 1) + "\n";
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

/// Joins shards that hold the lock: whether they do, and are of the same plan.
bool join_shards(int descriptor, const std::string& plan) {
  return ::flock(descriptor, LOCK_SH | LOCK_NB) == 0 && owner_in(descriptor) == shards_of(plan);
}

/// A descriptor that holds the lock, together with other shards of `plan` unless that is empty. File systems that know
/// no locks are trusted.
Result<int> take_lock(const fs::path& folder, const std::string& plan) {
  const fs::path path = lock_of(folder);
  for (int attempt = 0;; ++attempt) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) return tl::unexpected(write_error("the output cannot be written", errno, folder));
    const bool taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (taken && !(!plan.empty() && join_shards(descriptor, plan))) {
      const std::string owner = owner_in(descriptor);
      ::close(descriptor);
      if (!plan.empty() && attempt < kAttempts) {
        std::this_thread::sleep_for(kBetweenAttempts);
        continue;
      }
      return fail("another run writes to this folder" + (owner.empty() ? owner : ": " + owner), folder.string(),
                  "wait for its end or choose another output folder");
    }
    if (!is_still_there(descriptor, path)) {
      ::close(descriptor);
      continue;
    }
    if (taken) return descriptor;
    write_owner(descriptor, plan.empty() ? this_process() : shards_of(plan));
    // Between the two kinds of lock another may come first: then this one begins again.
    if (plan.empty() || ::flock(descriptor, LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK) return descriptor;
    ::close(descriptor);
  }
}

}  // namespace

Result<OutputFolder> OutputFolder::open(const fs::path& folder) { return open_with(folder, ""); }

Result<OutputFolder> OutputFolder::open_shared(const fs::path& folder, const std::string& plan) {
  return open_with(folder, plan);
}

Result<OutputFolder> OutputFolder::open_with(const fs::path& folder, const std::string& plan) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return fail("the output is a file, a folder is wanted", folder.string(), "name another folder with -o");
  }
  error.clear();
  const bool created = fs::create_directories(folder, error);
  if (error) return tl::unexpected(write_error("the output folder cannot be created", error.value(), folder));
  const Result<int> descriptor = take_lock(folder, plan);
  if (!descriptor) {
    if (created) fs::remove(folder, error);
    return tl::unexpected(descriptor.error());
  }
  return OutputFolder(folder, created, *descriptor);
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)), created_(other.created_), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFolder::~OutputFolder() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) fs::remove(lock_of(folder_), ignored);
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
