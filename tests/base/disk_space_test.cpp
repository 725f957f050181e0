#include "base/disk_space.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>

#include "base/atomic_file.h"
#include "base/temporary_folder.h"

namespace isthmus {
namespace {

TEST(DiskSpace, bytes_read_like_a_person_says_them) {
  EXPECT_EQ(bytes_text(0), "0 bytes");
  EXPECT_EQ(bytes_text(999), "999 bytes");
  EXPECT_EQ(bytes_text(1000), "1.0 kB");
  EXPECT_EQ(bytes_text(53'400), "53 kB");
  EXPECT_EQ(bytes_text(1'230'000), "1.2 MB");
  EXPECT_EQ(bytes_text(77'000'000'000), "77 GB");
}

TEST(DiskSpace, of_a_folder_that_is_not_there_yet_is_that_of_the_one_above) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(free_bytes_at(folder.path()));
  EXPECT_TRUE(free_bytes_at(folder / "not" / "there" / "yet"));
}

TEST(DiskSpace, a_full_disk_is_named_with_what_is_needed_and_what_to_try) {
  const testing::TemporaryFolder folder;
  const std::string text = write_error("cannot be written", ENOSPC, folder / "f", 1'200'000).text();
  EXPECT_TRUE(text.starts_with((folder / "f").string() + ": cannot be written: No space left on device, 1.2 MB are "
                                                         "needed and "))
      << text;
  EXPECT_TRUE(text.ends_with(" are free (free some space or choose another folder)")) << text;
}

TEST(DiskSpace, another_reason_speaks_of_no_space) {
  const std::string text = write_error("cannot be created", EACCES, "/a/b", 5).text();
  EXPECT_EQ(text, "/a/b: cannot be created: Permission denied (check the folder and its permissions)");
}

}  // namespace
}  // namespace isthmus
