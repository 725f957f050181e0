#include "store/collect.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/temporary_folder.h"
#include "store/store.h"

namespace isthmus::store {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;

class Collecting : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  fs::path store_ = folder_ / "store";

  static Key key(const std::string& digest) { return {"pair", digest}; }
  /// An artifact of about a thousand bytes that was made so long ago.
  fs::path add(const std::string& digest, hours age) {
    const auto store = Store::open(store_, {});
    EXPECT_TRUE(store && store->save(key(digest), std::string(1000, 'x')));
    const fs::path path = store->path_of(key(digest));
    fs::last_write_time(path, fs::file_time_type::clock::now() - age);
    return path;
  }
  Collected collect_now(const CollectLimits& limits = {}, bool dry_run = false) {
    const auto collected = collect(store_, {"pair/aa00"}, limits, dry_run);
    EXPECT_TRUE(collected) << collected.error().text();
    return collected.value_or(Collected{});
  }
};

TEST_F(Collecting, removes_what_is_not_needed_and_halves_of_files_and_nothing_else) {
  const fs::path needed = add("aa00", hours(99)), spare = add("bb00", hours(1));
  const fs::path half = needed.string() + ".tmp-12-3";
  std::ofstream(half) << "half";
  std::ofstream(store_ / "notes.artifact") << "a person's";
  const Collected collected = collect_now();
  EXPECT_EQ(collected.num_needed, 1U);
  EXPECT_EQ(collected.num_removed, 2U);
  EXPECT_GT(collected.bytes_removed, 1000U);
  EXPECT_EQ(collected.bytes_left, fs::file_size(needed));
  EXPECT_TRUE(fs::exists(needed));
  EXPECT_FALSE(fs::exists(spare));
  EXPECT_FALSE(fs::exists(half));
  EXPECT_TRUE(fs::exists(store_ / "notes.artifact"));
}

TEST_F(Collecting, a_dry_run_says_the_same_and_removes_nothing) {
  const fs::path needed = add("aa00", hours(1)), spare = add("bb00", hours(1));
  EXPECT_EQ(collect_now({}, true).num_removed, 1U);
  EXPECT_TRUE(fs::exists(spare));
  EXPECT_EQ(collect_now().num_removed, 1U);
}

TEST_F(Collecting, keeps_the_young_if_asked) {
  add("aa00", hours(99));
  const fs::path young = add("bb00", hours(1)), old = add("cc00", hours(30));
  const Collected collected = collect_now({std::chrono::hours(24), std::nullopt});
  EXPECT_EQ(collected.num_kept, 1U);
  EXPECT_TRUE(fs::exists(young));
  EXPECT_FALSE(fs::exists(old));
}

TEST_F(Collecting, keeps_the_youngest_that_fit_the_size_and_always_what_is_needed) {
  const fs::path needed = add("aa00", hours(99));
  const fs::path young = add("bb00", hours(1)), old = add("cc00", hours(2));
  const std::uint64_t bytes = fs::file_size(needed);
  EXPECT_EQ(collect_now({std::nullopt, 2 * bytes}).num_removed, 1U);
  EXPECT_TRUE(fs::exists(young));
  EXPECT_FALSE(fs::exists(old));
  EXPECT_EQ(collect_now({std::nullopt, 1}).num_needed, 1U);
  EXPECT_TRUE(fs::exists(needed));
  EXPECT_FALSE(fs::exists(young));
}

TEST_F(Collecting, is_refused_while_a_run_works_in_the_store_and_the_other_way_round) {
  add("aa00", hours(1));
  {
    const auto used = Store::open(store_, {});
    ASSERT_TRUE(used);
    EXPECT_TRUE(Store::open(store_, {})) << "runs share a store";
    const auto refused = collect(store_, {}, {}, false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what, "a run works in this store");
  }
  const auto held = StoreLock::take(store_, StoreLock::Kind::exclusive);
  const auto refused = Store::open(store_, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "the store is being cleaned");
}

TEST_F(Collecting, knows_the_outputs_that_still_exist) {
  const auto store = Store::open(store_, {});
  ASSERT_TRUE(store);
  fs::create_directories(folder_ / "there");
  store->add_user(folder_ / "there");
  store->add_user(folder_ / "there");
  store->add_user(folder_ / "gone");
  EXPECT_EQ(users_of(store_), std::set<fs::path>{folder_ / "there"});
  EXPECT_TRUE(users_of(folder_ / "nowhere").empty());
}

}  // namespace
}  // namespace isthmus::store
