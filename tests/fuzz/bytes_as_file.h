// Bytes of the fuzzer as a file, for code that opens paths.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace isthmus::fuzz {

/// A file of this name in a folder of its own, in memory where the system has /dev/shm; removed at the end.
class BytesAsFile {
 public:
  explicit BytesAsFile(const std::string& name) {
    const std::filesystem::path shm = "/dev/shm";
    const auto parent = std::filesystem::exists(shm) ? shm : std::filesystem::temp_directory_path();
    std::string pattern = (parent / "isthmus_fuzz_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) std::abort();
    folder_ = pattern;
    path_ = folder_ / name;
    std::filesystem::create_directories(path_.parent_path());
  }
  ~BytesAsFile() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  BytesAsFile(const BytesAsFile&) = delete;
  BytesAsFile& operator=(const BytesAsFile&) = delete;

  void write(std::string_view bytes) const {
    const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0 || ::write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
    ::close(file);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace isthmus::fuzz
