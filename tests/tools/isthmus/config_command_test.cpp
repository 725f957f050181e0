#include <gtest/gtest.h>

#include "base/run_program.h"
#include "base/temporary_folder.h"

namespace isthmus {
namespace {

class ConfigCommand : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  testing::Said run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "config");
    return testing::run_program(ISTHMUS_PROGRAM, arguments, folder_.path());
  }
  testing::Said check(const std::string& text) {
    std::ofstream(folder_ / "file.yaml") << text;
    return run({"check", (folder_ / "file.yaml").string()});
  }
};

TEST_F(ConfigCommand, default_is_the_file_of_the_repo_and_passes_its_own_check) {
  const testing::Said said = run({"default"});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_EQ(said.out, testing::text_of_file(std::filesystem::path(ISTHMUS_SOURCE_DIR) / "configs/default.yaml"));
  const testing::Said checked = check(said.out);
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
}

TEST_F(ConfigCommand, check_names_line_and_column) {
  const testing::Said said = check("sampling:\n  voxel_m: 0.1\n  target_point: 5\n");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.err, "error: " + (folder_ / "file.yaml").string() +
                          ":3:3: unknown key 'target_point' (did you mean target_points?)\n");
  EXPECT_EQ(check("sampling:\n  target_points: 1\n").exit_code, 2);
  EXPECT_EQ(run({"check", "/no/such/file.yaml"}).exit_code, 2);
}

TEST_F(ConfigCommand, check_knows_job_files) {
  EXPECT_EQ(check("input: a\noutput: b\nsettings: {sampling: {voxel_m: 1}}\n").exit_code, 0);
  EXPECT_EQ(check("input: a\noutput: b\nsettings: {sampling: {vxel_m: 1}}\n").exit_code, 2);
  EXPECT_EQ(check("- {input: a, output: b}\n").exit_code, 0);
}

TEST_F(ConfigCommand, explain_says_what_a_key_or_a_section_does) {
  const testing::Said key = run({"explain", "sampling.voxel_m"});
  EXPECT_EQ(key.exit_code, 0);
  EXPECT_TRUE(key.out.starts_with("sampling.voxel_m (number or auto, ")) << key.out;
  const testing::Said section = run({"explain", "run"});
  EXPECT_EQ(section.exit_code, 0);
  EXPECT_NE(section.out.find("run.threads"), std::string::npos);
  EXPECT_NE(run({"explain", "sampling.voxl_m"}).err.find("did you mean sampling.voxel_m?"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
