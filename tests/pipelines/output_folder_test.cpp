#include "pipelines/output_folder.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/temporary_folder.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

TEST(OutputFolder, is_made_with_its_parents_and_goes_again_if_nothing_came_of_it) {
  const testing::TemporaryFolder folder;
  const fs::path out = folder / "a" / "b";
  {
    const auto held = OutputFolder::open(out);
    ASSERT_TRUE(held) << held.error().text();
    EXPECT_TRUE(fs::exists(out / ".lock"));
  }
  EXPECT_FALSE(fs::exists(out));
  {
    const auto held = OutputFolder::open(out);
    ASSERT_TRUE(held);
    std::ofstream(out / "result") << "x";
  }
  EXPECT_TRUE(fs::exists(out / "result"));
  EXPECT_FALSE(fs::exists(out / ".lock"));
}

TEST(OutputFolder, that_was_there_stays) {
  const testing::TemporaryFolder folder;
  { ASSERT_TRUE(OutputFolder::open(folder.path())); }
  EXPECT_TRUE(fs::exists(folder.path()));
}

TEST(OutputFolder, is_refused_while_another_holds_it) {
  const testing::TemporaryFolder folder;
  {
    const auto first = OutputFolder::open(folder / "out");
    ASSERT_TRUE(first);
    const auto second = OutputFolder::open(folder / "out");
    ASSERT_FALSE(second);
    EXPECT_TRUE(second.error().what.starts_with("another run writes to this folder: process ")) << second.error().what;
    EXPECT_TRUE(fs::exists(folder / "out" / ".lock")) << "the refused one must not take it away";
  }
  EXPECT_TRUE(OutputFolder::open(folder / "out"));
}

TEST(OutputFolder, takes_over_the_lock_file_of_a_killed_run) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / ".lock") << "process 1 on nowhere\n" << std::string(5000, '\0');
  EXPECT_TRUE(OutputFolder::open(folder.path()));
}

TEST(OutputFolder, reserves_space_and_gives_it_back) {
  const testing::TemporaryFolder folder;
  auto held = OutputFolder::open(folder.path());
  ASSERT_TRUE(held);
  ASSERT_TRUE(held->reserve(100'000));
  EXPECT_GE(fs::file_size(folder / ".lock"), 100'000U);
  held->give_back();
  EXPECT_LT(fs::file_size(folder / ".lock"), 1000U);
  const auto refused = held->reserve(std::uint64_t{1} << 60);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("there is no space for the results"), std::string::npos);
  EXPECT_LT(fs::file_size(folder / ".lock"), 1000U);
}

TEST(OutputFolder, is_held_together_by_the_shards_of_one_plan) {
  const testing::TemporaryFolder folder;
  {
    const auto first = OutputFolder::open_shared(folder / "out", "plan-a");
    ASSERT_TRUE(first) << first.error().text();
    {
      const auto second = OutputFolder::open_shared(folder / "out", "plan-a");
      ASSERT_TRUE(second) << second.error().text();
    }
    EXPECT_TRUE(fs::exists(folder / "out" / ".lock")) << "the first one still works";
    const auto whole = OutputFolder::open(folder / "out");
    ASSERT_FALSE(whole);
    EXPECT_EQ(whole.error().what, "another run writes to this folder: shards of plan plan-a");
    EXPECT_FALSE(OutputFolder::open_shared(folder / "out", "plan-b"));
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
  const auto whole = OutputFolder::open(folder / "out");
  ASSERT_TRUE(whole);
  EXPECT_FALSE(OutputFolder::open_shared(folder / "out", "plan-a"));
}

}  // namespace
}  // namespace isthmus::pipelines
