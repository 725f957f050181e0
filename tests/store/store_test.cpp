#include "store/store.h"

#include <gtest/gtest.h>

#include <mutex>
#include <thread>

#include "base/atomic_file.h"
#include "base/temporary_folder.h"
#include "store/sample.h"

namespace isthmus::store {
namespace {

Key key_of(const std::string& input) { return make_key("sample", "1", std::vector<std::string>{input}); }

class StoreOfSamples : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  std::mutex mutex_;
  std::vector<std::string> damages_;
  Store store_ = Store::open(folder_ / "store", [this](const Error& e) {
                   const std::lock_guard lock(mutex_);
                   damages_.push_back(e.text());
                 }).value();
};

TEST(StoreKey, depends_on_every_part) {
  const std::string base = make_key("a", "1", std::vector<std::string>{"x", "y"}).digest;
  EXPECT_NE(make_key("b", "1", std::vector<std::string>{"x", "y"}).digest, base);
  EXPECT_NE(make_key("a", "2", std::vector<std::string>{"x", "y"}).digest, base);
  EXPECT_NE(make_key("a", "1", std::vector<std::string>{"y", "x"}).digest, base);
  EXPECT_NE(make_key("a", "1", std::vector<std::string>{"xy"}).digest, base);
  EXPECT_EQ(make_key("a", "1", std::vector<std::string>{"x", "y"}).digest, base);
}

TEST_F(StoreOfSamples, keeps_what_was_saved) {
  EXPECT_FALSE(store_.load<Sample>(key_of("x")));
  ASSERT_TRUE(store_.save(key_of("x"), full_sample()));
  const auto read = store_.load<Sample>(key_of("x"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text, full_sample().text);
  EXPECT_FALSE(store_.load<Sample>(key_of("y")));
  EXPECT_TRUE(damages_.empty());
}

TEST_F(StoreOfSamples, notices_a_flipped_bit_in_every_byte) {
  ASSERT_TRUE(store_.save(key_of("x"), full_sample()));
  const auto path = store_.path_of(key_of("x"));
  const std::string good = read_file(path).value();
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    ASSERT_TRUE(write_file_atomically(path, bad));
    EXPECT_FALSE(store_.load<Sample>(key_of("x"))) << "byte " << i;
  }
  EXPECT_EQ(damages_.size(), good.size());
  EXPECT_NE(damages_[0].find(path.string()), std::string::npos);
  ASSERT_TRUE(store_.save(key_of("x"), full_sample()));
  EXPECT_TRUE(store_.load<Sample>(key_of("x")));
}

TEST_F(StoreOfSamples, notices_a_file_cut_at_any_length) {
  ASSERT_TRUE(store_.save(key_of("x"), full_sample()));
  const auto path = store_.path_of(key_of("x"));
  const std::string good = read_file(path).value();
  for (std::size_t length = 0; length < good.size(); length += 7) {
    ASSERT_TRUE(write_file_atomically(path, good.substr(0, length)));
    EXPECT_FALSE(store_.load<Sample>(key_of("x"))) << length;
  }
}

TEST_F(StoreOfSamples, notices_a_file_in_another_ones_place_and_another_type) {
  ASSERT_TRUE(store_.save(key_of("x"), full_sample()));
  std::filesystem::create_directories(store_.path_of(key_of("y")).parent_path());
  std::filesystem::copy_file(store_.path_of(key_of("x")), store_.path_of(key_of("y")));
  EXPECT_FALSE(store_.load<Sample>(key_of("y")));
  EXPECT_NE(damages_.at(0).find("was stored as"), std::string::npos);
  EXPECT_FALSE(store_.load<Inner>(key_of("x")));
  EXPECT_EQ(damages_.size(), 2U);
}

TEST_F(StoreOfSamples, many_writers_and_readers_never_see_half_an_artifact) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 25; ++i) {
        EXPECT_TRUE(store_.save(key_of("shared"), full_sample()));
        EXPECT_TRUE(store_.load<Sample>(key_of("shared")));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(damages_.empty());
}

TEST_F(StoreOfSamples, what_cannot_be_kept_is_told_once) {
  ASSERT_TRUE(write_file_atomically(store_.folder() / "sample", "in the way of a folder"));
  EXPECT_FALSE(store_.save(key_of("x"), full_sample()));
  store_.keep(key_of("x"), full_sample());
  store_.keep(key_of("y"), full_sample());
  ASSERT_EQ(damages_.size(), 1U);
  EXPECT_NE(damages_[0].find("cannot be kept"), std::string::npos) << damages_[0];
}

TEST(StoreOfNothing, keeps_nothing_and_complains_about_nothing) {
  const Store store = Store::none();
  EXPECT_TRUE(store.save(key_of("x"), full_sample()));
  store.keep(key_of("x"), full_sample());
  EXPECT_FALSE(store.load<Sample>(key_of("x")));
}

TEST(StoreFolder, that_cannot_be_made_is_an_error) { EXPECT_FALSE(Store::open("/proc/no/such/folder", {})); }

}  // namespace
}  // namespace isthmus::store
