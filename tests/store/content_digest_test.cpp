#include "store/content_digest.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "base/temporary_folder.h"

namespace isthmus::store {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& content) { std::ofstream(path, std::ios::binary) << content; }

void age(const fs::path& path, int seconds) {
  fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::seconds(seconds));
}

bool has_index(const fs::path& store) { return fs::exists(store / "content"); }

TEST(ContentDigest, follows_the_bytes_not_the_name) {
  const testing::TemporaryFolder folder;
  const Store store = Store::open(folder / "store", {}).value();
  write(folder / "a", "hello");
  write(folder / "b", "hello");
  write(folder / "c", "hullo");
  EXPECT_EQ(content_digest(folder / "a", store).value(), content_digest(folder / "b", store).value());
  EXPECT_NE(content_digest(folder / "a", store).value(), content_digest(folder / "c", store).value());
  EXPECT_FALSE(content_digest(folder / "missing", store));
}

TEST(ContentDigest, is_remembered_for_settled_files_only) {
  const testing::TemporaryFolder folder;
  const Store store = Store::open(folder / "store", {}).value();
  write(folder / "a", "hello");
  ASSERT_TRUE(content_digest(folder / "a", store));
  EXPECT_FALSE(has_index(folder / "store"));
  age(folder / "a", 60);
  ASSERT_TRUE(content_digest(folder / "a", store));
  EXPECT_TRUE(has_index(folder / "store"));
}

TEST(ContentDigest, notices_a_change_of_the_same_length) {
  const testing::TemporaryFolder folder;
  const Store store = Store::open(folder / "store", {}).value();
  write(folder / "a", "hello");
  age(folder / "a", 60);
  const std::string before = content_digest(folder / "a", store).value();
  EXPECT_EQ(content_digest(folder / "a", store).value(), before);
  write(folder / "a", "hallo");
  age(folder / "a", 30);
  EXPECT_NE(content_digest(folder / "a", store).value(), before);
}

}  // namespace
}  // namespace isthmus::store
