#include "base/disk_space.h"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <cerrno>
#include <cstring>

namespace isthmus {
namespace {

bool means_full(int error_number) { return error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG; }

}  // namespace

std::optional<std::uint64_t> free_bytes_at(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::absolute(path, error);
  while (!std::filesystem::exists(folder, error) && folder != folder.parent_path()) folder = folder.parent_path();
  struct statvfs info {};
  if (::statvfs(folder.c_str(), &info) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr double kStep = 1000;
  if (bytes < static_cast<std::uint64_t>(kStep)) return fmt::format("{} bytes", bytes);
  auto value = static_cast<double>(bytes) / kStep;
  const char* unit = "kB";
  for (const char* next : {"MB", "GB", "TB"}) {
    if (value < kStep) break;
    value /= kStep;
    unit = next;
  }
  return value < 10 ? fmt::format("{:.1f} {}", value, unit) : fmt::format("{:.0f} {}", value, unit);
}

Error write_error(const std::string& what, int error_number, const std::filesystem::path& path,
                  std::optional<std::uint64_t> wanted_bytes) {
  Error error{what + ": " + std::strerror(error_number), path.string(), "check the folder and its permissions"};
  if (!means_full(error_number)) return error;
  error.hint = "free some space or choose another folder";
  const std::optional<std::uint64_t> free = free_bytes_at(path);
  if (wanted_bytes) error.what += fmt::format(", {} are needed", bytes_text(*wanted_bytes));
  if (free && wanted_bytes && error_number == ENOSPC) error.what += fmt::format(" and {} are free", bytes_text(*free));
  return error;
}

}  // namespace isthmus
