#include <gtest/gtest.h>

#include "base/run_program.h"
#include "base/temporary_folder.h"

namespace isthmus {
namespace {

TEST(InspectCommand, prints_good_files_and_is_1_if_any_is_unreadable) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "good.xyz") << "0 0 0\n1 2 3\n4 4 1\n";
  std::ofstream(folder / "bad.ply") << "ply\nformat nonsense 1.0\n";
  const std::string good = (folder / "good.xyz").string(), bad = (folder / "bad.ply").string();
  const testing::Said one = testing::run_program(ISTHMUS_PROGRAM, {"inspect", good}, folder.path());
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_NE(one.out.find("points     3\n"), std::string::npos) << one.out;
  EXPECT_NE(one.out.find("to         4 4 3\n"), std::string::npos) << one.out;
  const testing::Said both = testing::run_program(ISTHMUS_PROGRAM, {"inspect", bad, good}, folder.path());
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_NE(both.out.find("points     3\n"), std::string::npos) << "the good one is printed all the same";
  EXPECT_NE(both.err.find(bad), std::string::npos);
}

}  // namespace
}  // namespace isthmus
