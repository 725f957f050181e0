#include "pipelines/slurm.h"

#include <gtest/gtest.h>

namespace isthmus::pipelines {
namespace {

class Arrays : public ::testing::Test {
 protected:
  Job job_;
  SlurmOptions options_;
  Outlook outlook_;
  void SetUp() override {
    job_.settings.run.threads = 1;
    options_.task_minutes = 10;
    outlook_.scans_to_make = 30;
    outlook_.pairs_to_make = 90;
    outlook_.seconds = 120 * 60;  // a minute each
  }
  std::string text(std::size_t max_array_size = 1001) {
    std::string out;
    for (const SlurmJob& job : slurm_jobs(outlook_, job_, options_, max_array_size)) {
      out += job.stage + "=" + std::to_string(job.tasks) + " ";
    }
    return out;
  }
};

TEST_F(Arrays, pack_short_items) { EXPECT_EQ(text(), "look=3 scans=3 pairs=9 pairs2=9 solve=1 "); }

TEST_F(Arrays, respect_both_limits) {
  options_.task_minutes = 0.01;
  EXPECT_EQ(text(), "look=30 scans=30 pairs=90 pairs2=90 solve=1 ");
  options_.most_tasks = 40;
  EXPECT_EQ(text(), "look=30 scans=30 pairs=40 pairs2=40 solve=1 ");
  EXPECT_EQ(text(9), "look=8 scans=8 pairs=8 pairs2=8 solve=1 ");
}

TEST_F(Arrays, leave_out_what_is_there) {
  outlook_.scans_to_make = 0;
  outlook_.pairs_to_make = 1;
  options_.pair_rounds = 1;
  EXPECT_EQ(text(), "pairs=1 solve=1 ");
  outlook_.pairs_to_make = 0;
  EXPECT_EQ(text(), "solve=1 ");
}

TEST_F(Arrays, scripts_run_the_shard_of_their_task_and_quote_paths) {
  options_.program = "/opt/is thmus/isthmus";
  options_.partition = "night";
  options_.cpus = 2;
  const std::string script = slurm_script({"", "pairs", 7}, "/data/it's", options_);
  EXPECT_NE(script.find("#SBATCH --array=1-7\n"), std::string::npos) << script;
  EXPECT_NE(script.find("#SBATCH --partition=night\n"), std::string::npos) << script;
  EXPECT_NE(script.find("'/opt/is thmus/isthmus' run '/data/it'\\''s/job.yaml' --threads 2 --shard "
                        "\"$SLURM_ARRAY_TASK_ID/7\" --wait 0\n"),
            std::string::npos)
      << script;
  const std::string solve = slurm_script({"", "solve", 1}, "/data", options_);
  EXPECT_EQ(solve.find("--array"), std::string::npos) << solve;
  EXPECT_EQ(solve.find("--shard"), std::string::npos) << solve;
}

}  // namespace
}  // namespace isthmus::pipelines
