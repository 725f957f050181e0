#include "base/atomic_file.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "base/temporary_folder.h"

namespace isthmus {
namespace {

std::size_t num_files(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, reads_back_what_was_written) {
  const testing::TemporaryFolder folder;
  const std::string content("a\0b\n", 4);
  ASSERT_TRUE(write_file_atomically(folder / "f", content));
  EXPECT_EQ(read_file(folder / "f").value(), content);
  ASSERT_TRUE(write_file_atomically(folder / "f", ""));
  EXPECT_EQ(read_file(folder / "f").value(), "");
  EXPECT_EQ(num_files(folder.path()), 1U);
}

TEST(AtomicFile, names_the_missing_folder_and_leaves_nothing) {
  const testing::TemporaryFolder folder;
  const Result<void> written = write_file_atomically(folder / "no" / "f", "x");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().text().find((folder / "no").string()), std::string::npos);
  EXPECT_EQ(num_files(folder.path()), 0U);
}

TEST(AtomicFile, leaves_no_temporary_file_when_the_rename_fails) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "taken" / "inside");
  EXPECT_FALSE(write_file_atomically(folder / "taken", "x"));
  EXPECT_EQ(num_files(folder.path()), 1U);
}

TEST(AtomicFile, a_missing_file_is_an_error_that_names_it) {
  const Result<std::string> content = read_file("/nowhere/at/all");
  ASSERT_FALSE(content);
  EXPECT_NE(content.error().text().find("/nowhere/at/all"), std::string::npos);
}

TEST(AtomicFile, readers_among_writers_see_whole_files_only) {
  const testing::TemporaryFolder folder;
  const auto path = folder / "f";
  ASSERT_TRUE(write_file_atomically(path, std::string(50000, 'a')));
  std::vector<std::thread> writers;
  for (const char letter : {'b', 'c', 'd'}) {
    writers.emplace_back([&, letter] {
      for (int i = 0; i < 20; ++i) EXPECT_TRUE(write_file_atomically(path, std::string(50000, letter)));
    });
  }
  for (int i = 0; i < 200; ++i) {
    const std::string content = read_file(path).value();
    ASSERT_EQ(content, std::string(50000, content[0]));
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(num_files(folder.path()), 1U);
}

}  // namespace
}  // namespace isthmus
