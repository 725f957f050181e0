// What a person gets who types something wrong, or asks for help.
#include <gtest/gtest.h>

#include "base/run_program.h"
#include "base/temporary_folder.h"

namespace isthmus {
namespace {

class Usage : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  testing::Said run(const std::vector<std::string>& arguments) {
    return testing::run_program(ISTHMUS_PROGRAM, arguments, folder_.path());
  }
  std::string path(const std::string& name) { return (folder_ / name).string(); }
};

TEST_F(Usage, help_and_version_go_to_standard_output) {
  const testing::Said help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("isthmus register scans/ -o out/"), std::string::npos);
  EXPECT_EQ(help.err, "");
  EXPECT_EQ(run({"--version"}).out, "isthmus 0.1.0\n");
  for (const std::string command : {"register", "run", "pair", "inspect", "simulate", "evaluate", "export", "config"}) {
    const testing::Said said = run({command, "--help"});
    EXPECT_EQ(said.exit_code, 0) << command;
    EXPECT_NE(said.out.find("Usage: isthmus " + command), std::string::npos) << said.out;
  }
}

TEST_F(Usage, wrong_usage_is_2_and_silent_on_standard_output) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"regster", "scans"},
      {"register"},
      {"register", "scans"},
      {"register", "scans", "-o"},
      {"register", "scans", "-o", path("out"), "--unknown"},
      {"register", "scans", "-o", path("out"), "--threads", "0"},
      {"register", "scans", "-o", path("out"), "--threads", "two"},
      {"register", "scans", "-o", path("out"), "--set", "sampling.vxel_m=1"},
      {"register", "scans", "-o", path("out"), "--set", "sampling.voxel_m=-1"},
      {"register", "scans", "-o", path("out"), "-c", path("missing.yaml")},
      {"run", path("missing.yaml")},
      {"pair", "a.ply"},
      {"pair", "a.ply", "b.ply", "--set", "nonsense"},
      {"inspect"},
      {"simulate", "office"},
      {"simulate", "office", "-o", path("x"), "--stations", "many"},
      {"evaluate", "out"},
      {"export", "out"},
      {"export", "out", "--poses", "nonsense"},
      {"config"},
      {"config", "explain", "sampling.nothing"},
  };
  for (const auto& arguments : wrong) {
    const testing::Said said = run(arguments);
    std::string line;
    for (const std::string& word : arguments) line += word + " ";
    EXPECT_EQ(said.exit_code, 2) << line << "\n" << said.err;
    EXPECT_EQ(said.out, "") << line;
    EXPECT_NE(said.err, "") << line;
  }
  EXPECT_FALSE(std::filesystem::exists(path("out"))) << "nothing may be begun";
}

TEST_F(Usage, a_misspelt_setting_names_the_nearest_one) {
  const testing::Said said = run({"register", "scans", "-o", path("out"), "--set", "sampling.vxel_m=1"});
  EXPECT_EQ(said.err,
            "error: --set sampling.vxel_m=1: unknown key 'sampling.vxel_m' (did you mean sampling.voxel_m?)\n");
}

TEST_F(Usage, missing_or_empty_input_is_a_failure) {
  std::filesystem::create_directories(folder_ / "empty");
  const testing::Said missing = run({"register", path("nowhere"), "-o", path("out")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find(path("nowhere")), std::string::npos) << missing.err;
  const testing::Said empty = run({"register", path("empty"), "-o", path("out")});
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_NE(empty.err.find("no scans found"), std::string::npos) << empty.err;
  EXPECT_EQ(run({"evaluate", path("nowhere"), "--truth", path("truth.txt")}).exit_code, 1);
}

TEST_F(Usage, an_output_that_cannot_be_written_is_a_failure_that_names_it) {
  std::ofstream(folder_ / "file") << "not a folder";
  std::ofstream(folder_ / "a.xyz") << "1 2 3\n4 5 6\n";
  const testing::Said said = run({"register", path("a.xyz"), "-o", path("file/out")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find(path("file/out")), std::string::npos) << said.err;
}

}  // namespace
}  // namespace isthmus
