// A rerun computes what changed and nothing else, and 'isthmus plan' says so beforehand.
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

class Rerun : public SurveyOnDisk {
 protected:
  const std::vector<std::string> voxel_ = {"--set", "sampling.voxel_m=0.1"};

  std::string made() { return run_json(out_)["run"]["products_made"]; }
  std::string plan(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"plan", scans_.string(), "-o", out_.string(), "--set", "sampling.voxel_m=0.1"});
    const Said said = run(more);
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return said.out;
  }
  Said register_with(std::vector<std::string> more = {}) {
    more.insert(more.begin(), voxel_.begin(), voxel_.end());
    return register_scans(more);
  }
  /// Other bytes in the place of a scan's, with nothing to tell: whoever reads the scan fails.
  void make_unreadable(const fs::path& scan) {
    const fs::file_time_type time = fs::last_write_time(scan);
    {
      std::fstream file(scan, std::ios::in | std::ios::out | std::ios::binary);
      file << "no scan at all";
    }
    fs::last_write_time(scan, time);
  }
  static bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
};

TEST_F(Rerun, with_nothing_changed_computes_nothing) {
  make_old_survey(3);
  const std::string before = plan();
  EXPECT_TRUE(has(before, "scans: 0 found, 3 to compute\n  new or changed file: scan_000.ply")) << before;
  EXPECT_TRUE(has(before, "pairs: about 3 to compute")) << before;
  EXPECT_TRUE(has(before, "by general figures")) << before;
  EXPECT_FALSE(fs::exists(out_)) << "a plan writes nothing";
  ASSERT_EQ(register_with().exit_code, 0);
  const std::string after = plan();
  EXPECT_TRUE(has(after, "scans: 3 found, 0 to compute\npairs: 3 found, 0 to compute\nnothing to compute")) << after;
  ASSERT_EQ(register_with().exit_code, 0);
  EXPECT_EQ(made(), "0");
}

TEST_F(Rerun, a_plan_says_when_glances_that_choose_the_pairs_are_not_cast_yet) {
  make_old_survey(3);
  ASSERT_EQ(register_with().exit_code, 0);  // every pair: no glances
  const std::vector<std::string> by_glances = {"--set", "candidates.all_pairs_up_to=2", "--set",
                                               "candidates.pairs_per_scan=1"};
  const std::string before = plan(by_glances);
  EXPECT_TRUE(has(before, "chosen by likeness alone")) << before;
  EXPECT_FALSE(has(before, "nothing to compute")) << before;
  ASSERT_EQ(register_with(by_glances).exit_code, 0);
  const std::string after = plan(by_glances);
  EXPECT_FALSE(has(after, "chosen by likeness alone")) << after;
  EXPECT_TRUE(has(after, "nothing to compute")) << after;
}

TEST_F(Rerun, with_another_pair_setting_reads_no_scan_and_computes_only_pairs) {
  make_old_survey(3);
  const std::vector<std::string> other = {"--set", "pair.max_hypotheses=60"};
  ASSERT_EQ(
      run({"register", scans_.string(), "-o", (folder_ / "other").string(), voxel_[0], voxel_[1], other[0], other[1]})
          .exit_code,
      0);
  ASSERT_EQ(register_with().exit_code, 0);
  for (const char* scan : {"scan_000.ply", "scan_001.ply", "scan_002.ply"}) make_unreadable(scans_ / scan);
  const std::string said = plan(other);
  EXPECT_TRUE(has(said,
                  "scans: 3 found, 0 to compute\npairs: 0 found, 3 to compute\n  pair.max_hypotheses is 60 instead "
                  "of 150: "))
      << said;
  EXPECT_TRUE(has(said, "by 6 scans and pairs of earlier runs")) << said;
  ASSERT_EQ(register_with(other).exit_code, 0);
  EXPECT_EQ(made(), "3");
  expect_same_bytes(out_, folder_ / "other");
}

TEST_F(Rerun, with_one_more_scan_computes_its_products_and_its_pairs) {
  make_old_survey(4);
  fs::rename(scans_ / "scan_003.ply", folder_ / "later.ply");
  ASSERT_NE(register_with().exit_code, 1);
  fs::rename(folder_ / "later.ply", scans_ / "scan_003.ply");
  const std::string said = plan();
  EXPECT_TRUE(has(said, "scans: 3 found, 1 to compute\n  new or changed file: scan_003.ply\n")) << said;
  EXPECT_TRUE(has(said, "pairs: 3 found, 3 to compute\n  one of the scans is to be computed: ")) << said;
  ASSERT_NE(register_with().exit_code, 1);
  const nlohmann::json run = run_json(out_)["run"];
  EXPECT_GE(std::stoi(made()), 3 + 3);
  EXPECT_LE(std::stoi(made()), 3 + 3 + 3) << "at most the pairs of the new scan again with a prediction: " << run;
}

TEST_F(Rerun, with_another_setting_of_an_early_stage_computes_from_there) {
  make_old_survey(2);
  ASSERT_EQ(register_with().exit_code, 0);
  const std::string said = plan({"--set", "features.max_keypoints=2000"});
  EXPECT_TRUE(has(said, "features.max_keypoints is 2000 instead of ")) << said;
  ASSERT_EQ(register_with({"--set", "features.max_keypoints=2000"}).exit_code, 0);
  EXPECT_EQ(made(), "5");  // features and regions of two scans, a pair
}

}  // namespace
}  // namespace isthmus::testing
