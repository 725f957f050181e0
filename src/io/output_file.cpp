#include "io/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "base/disk_space.h"

namespace isthmus::io {

OutputFile::OutputFile(int descriptor, std::filesystem::path path, std::string temporary)
    : descriptor_(descriptor), path_(std::move(path)), temporary_(std::move(temporary)) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)) {}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

tl::unexpected<Error> OutputFile::system_failure(std::string_view verb) const {
  return tl::unexpected(write_error("cannot be " + std::string(verb), errno, path_));
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& path) {
  constexpr int kTries = 1000;  // names left behind by killed runs
  for (int k = 0;; ++k) {
    const std::string temporary = path.string() + ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(k);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST && k < kTries) continue;
    OutputFile file(descriptor, path, temporary);
    if (descriptor < 0) return file.system_failure("created");
    return file;
  }
}

Result<void> OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return system_failure("written");
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return {};
}

Result<void> OutputFile::overwrite(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return system_failure("written");
    bytes.remove_prefix(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return {};
}

Result<void> OutputFile::publish() {
  if (::fsync(descriptor_) != 0) return system_failure("written");
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return system_failure("renamed");
  ::close(std::exchange(descriptor_, -1));
  return {};
}

}  // namespace isthmus::io
