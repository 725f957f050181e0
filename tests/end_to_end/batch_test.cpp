// Jobs from a file: relative paths, one failing among good ones, one exit code.
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

class Batch : public SurveyOnDisk {
 protected:
  Said run_jobs(const std::string& yaml) {
    std::ofstream(folder_ / "batch.yaml") << yaml;
    return run({"run", (folder_ / "batch.yaml").string()});
  }
};

TEST_F(Batch, a_job_that_fails_does_not_end_the_rest) {
  make_survey(2);
  const Said said = run_jobs(
      "- {input: missing, output: one}\n"
      "- {input: scans, output: two, settings: {run: {store: kept}}}\n"
      "- {input: [scans/scan_000.ply], output: three, settings: {run: {store: kept}}}\n");
  EXPECT_EQ(said.exit_code, 1) << said.err;
  EXPECT_EQ(std::ranges::count(said.out, '\n'), 3) << said.out;
  EXPECT_FALSE(fs::exists(folder_ / "one" / "scans.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "two" / "scans.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "three" / "scans.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "kept"));
  EXPECT_FALSE(fs::exists(folder_ / "two" / "store"));
}

TEST_F(Batch, a_wrong_job_file_begins_nothing) {
  make_survey(1);
  const Said said =
      run_jobs("- {input: scans, output: one}\n- {input: scans, output: two, settings: {sampling: {voxel: 1}}}\n");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_NE(said.err.find("batch.yaml:2:53: unknown key 'voxel' (did you mean voxel_m?)"), std::string::npos)
      << said.err;
  EXPECT_FALSE(fs::exists(folder_ / "one"));
}

TEST_F(Batch, two_jobs_with_one_output_begin_nothing) {
  make_survey(1);
  const Said said = run_jobs("- {input: scans, output: one}\n- {input: scans, output: ./one/}\n");
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_NE(said.err.find("batch.yaml:2:26: job 2 and job 1 (at "), std::string::npos) << said.err;
  EXPECT_NE(said.err.find("batch.yaml:1) write to the same folder"), std::string::npos) << said.err;
  EXPECT_FALSE(fs::exists(folder_ / "one"));
}

TEST_F(Batch, flags_override_every_job) {
  make_survey(1);
  std::ofstream(folder_ / "job.yaml") << "input: scans\noutput: out\nsettings: {sampling: {target_points: 9000}}\n";
  ASSERT_EQ(run({"run", (folder_ / "job.yaml").string(), "--set", "sampling.target_points=5000"}).exit_code, 0);
  const std::string resolved = text_of_file(out_ / "resolved.yaml");
  EXPECT_NE(resolved.find("target_points: 5000  # --set"), std::string::npos) << resolved;
}

}  // namespace
}  // namespace isthmus::testing
