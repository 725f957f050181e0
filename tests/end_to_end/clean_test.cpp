// What 'isthmus clean' takes away is never missed.
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

class Clean : public SurveyOnDisk {
 protected:
  std::string made(const fs::path& out) { return run_json(out)["run"]["products_made"]; }
  static std::size_t num_artifacts(const fs::path& store) {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(store)) {
      count += entry.path().extension() == ".artifact" ? 1 : 0;
    }
    return count;
  }
};

TEST_F(Clean, takes_what_earlier_settings_left_behind_and_nothing_that_the_next_run_needs) {
  make_old_survey(2);
  ASSERT_EQ(register_scans({"--set", "sampling.voxel_m=0.12"}).exit_code, 0);
  const std::size_t few = num_artifacts(out_ / "store");
  ASSERT_EQ(register_scans().exit_code, 0);
  const std::size_t many = num_artifacts(out_ / "store");
  ASSERT_GT(many, few);

  const Said dry = run({"clean", out_.string(), "--dry-run"});
  EXPECT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_NE(dry.out.find("would remove 12 products"), std::string::npos)
      << dry.out;  // 5 of each scan, a pair, the survey
  EXPECT_EQ(num_artifacts(out_ / "store"), many);
  EXPECT_NE(run({"clean", out_.string(), "--keep-days", "1"}).out.find("removed 0 products"), std::string::npos);

  const Said said = run({"clean", out_.string()});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.out.find("removed 12 products"), std::string::npos) << said.out;
  EXPECT_EQ(num_artifacts(out_ / "store"), many - 12);
  ASSERT_EQ(register_scans().exit_code, 0);
  EXPECT_EQ(made(out_), "0");
  EXPECT_NE(run({"clean", out_.string()}).out.find("removed 0 products"), std::string::npos);
}

TEST_F(Clean, of_a_shared_store_spares_what_the_other_output_needs) {
  make_old_survey(2);
  const std::string kept = (folder_ / "kept").string(), other = (folder_ / "other").string();
  ASSERT_EQ(register_scans({"--store", kept, "--set", "sampling.voxel_m=0.12"}).exit_code, 0);
  ASSERT_EQ(run({"register", scans_.string(), "-o", other, "--store", kept}).exit_code, 0);
  const Said said = run({"clean", other});
  EXPECT_NE(said.out.find("needed by 2 outputs"), std::string::npos) << said.out << said.err;
  ASSERT_EQ(register_scans({"--store", kept, "--set", "sampling.voxel_m=0.12"}).exit_code, 0);
  EXPECT_EQ(made(out_), "0");
  fs::remove_all(out_);
  const std::size_t before = num_artifacts(kept);
  EXPECT_NE(run({"clean", other}).out.find("removed 12 products"), std::string::npos);
  EXPECT_EQ(num_artifacts(kept), before - 12);
  ASSERT_EQ(run({"register", scans_.string(), "-o", other, "--store", kept}).exit_code, 0);
  EXPECT_EQ(run_json(other)["run"]["products_made"], "0");
}

TEST_F(Clean, takes_nothing_from_a_run_that_was_killed_and_will_go_on) {
  make_survey(3);
  StartedProgram program(ISTHMUS_PROGRAM, {"register", scans_.string(), "-o", out_.string()}, folder_.path());
  ASSERT_TRUE(program.wait_for("registering pairs", 120));
  const Said refused = run_program(ISTHMUS_PROGRAM, {"clean", out_.string()}, scans_);
  program.signal(SIGKILL);
  program.finish();
  EXPECT_EQ(refused.exit_code, 1) << "a run worked there";
  const std::size_t kept = num_artifacts(out_ / "store");
  EXPECT_EQ(run({"clean", out_.string()}).exit_code, 0);
  EXPECT_EQ(num_artifacts(out_ / "store"), kept);
}

TEST_F(Clean, says_what_is_missing) {
  EXPECT_EQ(run({"clean", out_.string()}).exit_code, 1);
  fs::create_directories(out_);
  const Said said = run({"clean", out_.string()});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find("there is no store"), std::string::npos) << said.err;
}

}  // namespace
}  // namespace isthmus::testing
