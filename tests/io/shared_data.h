// Where the shared scan data lies, if it is there.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace isthmus::io::testing {

/// $ISTHMUS_SHARED/data, else ../shared/data beside the source folder; nothing if neither exists.
inline std::optional<std::filesystem::path> shared_data() {
  const char* set = std::getenv("ISTHMUS_SHARED");
  const auto root =
      set != nullptr ? std::filesystem::path(set) : std::filesystem::path(ISTHMUS_SOURCE_DIR) / ".." / "shared";
  const auto data = root / "data";
  return std::filesystem::is_directory(data) ? std::optional(data) : std::nullopt;
}

}  // namespace isthmus::io::testing

/// At the start of a test: `data` is the folder, or the test is skipped with a reason one can see.
#define ISTHMUS_SHARED_DATA_OR_SKIP(data)                                                \
  const auto found_##data = isthmus::io::testing::shared_data();                         \
  if (!found_##data) GTEST_SKIP() << "no shared data: set ISTHMUS_SHARED to its folder"; \
  const std::filesystem::path data = *found_##data
