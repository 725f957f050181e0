// A run goes on where it stopped, whatever stopped it.
#include "end_to_end/survey_on_disk.h"
#include "store/journal.h"

namespace isthmus::testing {
namespace {

class Resume : public SurveyOnDisk {
 protected:
  std::string made(const fs::path& out) { return run_json(out)["run"]["products_made"]; }

  /// Flips one bit in the middle of each artifact of a stage; returns how many there are.
  int damage(const std::string& stage) {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(out_ / "store" / stage)) {
      if (!entry.is_regular_file()) continue;
      std::string bytes = text_of_file(entry.path());
      bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
      std::ofstream(entry.path(), std::ios::binary) << bytes;
      ++count;
    }
    return count;
  }
};

TEST_F(Resume, a_second_run_computes_nothing_and_says_the_same) {
  make_survey(3);
  ASSERT_EQ(register_scans().exit_code, 0);
  fs::copy(out_, folder_ / "first", fs::copy_options::recursive);
  EXPECT_NE(made(out_), "0");
  ASSERT_EQ(register_scans().exit_code, 0);
  EXPECT_EQ(made(out_), "0");
  expect_same_bytes(out_, folder_ / "first");

  // A shared store serves another output.
  const fs::path other = folder_ / "other";
  ASSERT_EQ(run({"register", scans_.string(), "-o", other.string(), "--store", (out_ / "store").string()}).exit_code,
            0);
  EXPECT_EQ(made(other), "0");
  EXPECT_FALSE(fs::exists(other / "store"));
  expect_same_bytes(out_, other);

  // The resolved job repeats the run.
  ASSERT_EQ(run({"run", (out_ / "resolved.yaml").string()}).exit_code, 0);
  EXPECT_EQ(made(out_), "0");
  expect_same_bytes(out_, folder_ / "first");
}

TEST_F(Resume, damaged_products_are_named_and_made_anew) {
  make_survey(2);
  ASSERT_EQ(register_scans().exit_code, 0);
  fs::copy(out_, folder_ / "first", fs::copy_options::recursive);
  ASSERT_EQ(damage("pair"), 1);
  ASSERT_EQ(damage("sampled"), 2);
  ASSERT_EQ(damage("summary"), 2);
  const Said said = register_scans();
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("damaged artifact"), std::string::npos) << said.err;
  expect_same_bytes(out_, folder_ / "first");
  ASSERT_EQ(register_scans().exit_code, 0);
  EXPECT_EQ(made(out_), "0");
}

TEST_F(Resume, one_more_scan_and_other_settings_of_a_late_stage_reuse_what_still_holds) {
  make_survey(3);
  fs::rename(scans_ / "scan_002.ply", folder_ / "later.ply");
  ASSERT_EQ(register_scans({"--set", "sampling.voxel_m=0.1"}).exit_code, 0);
  fs::rename(folder_ / "later.ply", scans_ / "scan_002.ply");
  ASSERT_EQ(register_scans({"--set", "sampling.voxel_m=0.1"}).exit_code, 0);
  EXPECT_EQ(made(out_), "5");  // three products of the new scan, two pairs
  ASSERT_EQ(register_scans({"--set", "sampling.voxel_m=0.1", "--set", "solve.noise_voxels=0.3"}).exit_code, 0);
  EXPECT_EQ(made(out_), "0");
}

TEST_F(Resume, a_run_stopped_by_ctrl_c_or_sigterm_finishes_what_is_in_flight_writes_the_journal_and_goes_on) {
  make_survey(3);
  ASSERT_EQ(run({"register", scans_.string(), "-o", (folder_ / "whole").string()}).exit_code, 0);
  for (const auto& [signal, while_it_says] : {std::pair(SIGINT, "registering pairs"), {SIGTERM, "describing scans"}}) {
    const fs::path out = folder_ / ("stopped" + std::to_string(signal));
    StartedProgram program(ISTHMUS_PROGRAM, {"register", scans_.string(), "-o", out.string(), "--threads", "1"},
                           folder_.path());
    ASSERT_TRUE(program.wait_for(while_it_says, 120));
    program.signal(signal);
    const Said said = program.finish();
    EXPECT_EQ(said.exit_code, 128 + signal) << said.err;
    EXPECT_NE(said.out.find("the same command goes on from there"), std::string::npos) << said.out;
    EXPECT_FALSE(fs::exists(out / "scans.csv"));

    const std::vector<store::ProcessJournal> journals = store::read_journals(out / "journal");
    ASSERT_EQ(journals.size(), 1U);
    EXPECT_GT(journals[0].count("began"), 0U);
    EXPECT_EQ(journals[0].count("began"), journals[0].count("made")) << "work in flight was not finished";
    EXPECT_EQ(journals[0].lines.front().event, "run");
    EXPECT_EQ(journals[0].lines.back().event, "stopped");

    ASSERT_EQ(run({"register", scans_.string(), "-o", out.string()}).exit_code, 0);
    EXPECT_NE(run_json(out)["run"]["products_found"], "0");
    EXPECT_EQ(store::read_journals(out / "journal").back().lines.back().event, "ended");
    expect_same_bytes(folder_ / "whole", out);
  }
}

TEST_F(Resume, a_killed_run_leaves_nothing_that_misleads_the_next) {
  make_survey(3);
  ASSERT_EQ(run({"register", scans_.string(), "-o", (folder_ / "whole").string()}).exit_code, 0);
  const fs::path out = folder_ / "killed";
  StartedProgram program(ISTHMUS_PROGRAM, {"register", scans_.string(), "-o", out.string()}, folder_.path());
  ASSERT_TRUE(program.wait_for("describing scans", 120));
  program.signal(SIGKILL);
  EXPECT_EQ(program.finish().exit_code, 128 + SIGKILL);
  const Said said = run({"register", scans_.string(), "-o", out.string()});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_EQ(said.err.find("damaged"), std::string::npos) << said.err;
  expect_same_bytes(folder_ / "whole", out);
}

}  // namespace
}  // namespace isthmus::testing
