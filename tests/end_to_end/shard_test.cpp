// One survey by several processes: the same bytes as by one.
#include "end_to_end/survey_on_disk.h"
#include "store/journal.h"

namespace isthmus::testing {
namespace {

class Shards : public SurveyOnDisk {
 protected:
  std::vector<std::string> command(const fs::path& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {
        "register", scans_.string(), "-o", out.string(), "--threads", "1", "--set", "sampling.target_points=4000"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  fs::path said_folder(int k) const {
    const fs::path folder = folder_ / ("said" + std::to_string(k));
    fs::create_directories(folder);
    return folder;
  }
};

TEST_F(Shards, three_at_the_same_time_give_the_bytes_of_one_process_and_do_nothing_twice) {
  make_survey(5);
  std::ofstream(scans_ / "broken.ply") << "ply\nformat nonsense 1.0\n";
  std::ofstream(scans_ / "few.xyz") << "1 2 3\n4 5 6\n";
  const fs::path whole = folder_ / "whole";
  const Said first = run(command(whole));
  ASSERT_EQ(first.exit_code, 3) << first.err;

  std::vector<StartedProgram> shards;
  for (int k = 1; k <= 3; ++k) {
    shards.emplace_back(ISTHMUS_PROGRAM, command(out_, {"--shard", std::to_string(k) + "/3"}), said_folder(k));
  }
  for (StartedProgram& shard : shards) {
    const Said said = shard.finish();
    EXPECT_EQ(said.exit_code, 0) << said.out << said.err;
    EXPECT_NE(said.out.find("the same command without --shard collects it"), std::string::npos) << said.out;
  }
  EXPECT_FALSE(fs::exists(out_ / "run.json"));
  EXPECT_FALSE(fs::exists(out_ / ".lock"));
  std::size_t made = 0;
  int busy = 0;
  for (const store::ProcessJournal& journal : store::read_journals(out_ / "journal")) {
    made += journal.count("made");
    busy += journal.count("made") > 0 ? 1 : 0;
  }
  EXPECT_EQ(busy, 3);
  EXPECT_EQ(std::to_string(made), run_json(whole)["run"]["products_made"].get<std::string>());

  ASSERT_EQ(run(command(out_)).exit_code, 3);
  EXPECT_EQ(run_json(out_)["run"]["products_made"], "0");
  expect_same_bytes(whole, out_);
}

TEST_F(Shards, one_after_the_other_without_waiting_come_to_the_same_end) {
  make_survey(3);
  const fs::path whole = folder_ / "whole";
  ASSERT_EQ(run(command(whole)).exit_code, 0);
  int rounds = 0;
  for (bool unfinished = true; unfinished; ++rounds) {
    ASSERT_LT(rounds, 8);
    unfinished = false;
    for (const char* shard : {"1/2", "2/2"}) {
      const Said said = run(command(out_, {"--shard", shard, "--wait", "0"}));
      ASSERT_TRUE(said.exit_code == 0 || said.exit_code == 4) << said.exit_code << said.err;
      EXPECT_EQ(said.exit_code == 4, said.out.find("run it again") != std::string::npos) << said.out;
      unfinished |= said.exit_code == 4;
    }
  }
  EXPECT_GT(rounds, 1);
  ASSERT_EQ(run(command(out_)).exit_code, 0);
  EXPECT_EQ(run_json(out_)["run"]["products_made"], "0");
  expect_same_bytes(whole, out_);
}

TEST_F(Shards, of_another_plan_and_whole_runs_are_refused_while_one_works) {
  make_survey(2);
  StartedProgram first(ISTHMUS_PROGRAM, command(out_, {"--shard", "1/2", "--wait", "60"}), said_folder(1));
  ASSERT_TRUE(first.wait_for("looking at scans", 120));
  const Said other = run(command(out_, {"--shard", "1/3"}));
  EXPECT_EQ(other.exit_code, 1) << other.err;
  EXPECT_NE(other.err.find("another run writes to this folder: shards of plan "), std::string::npos) << other.err;
  const Said settings = run(command(out_, {"--shard", "2/2", "--set", "pair.max_seeds=100"}));
  EXPECT_EQ(settings.exit_code, 1) << settings.err;
  EXPECT_EQ(run(command(out_)).exit_code, 1);
  const Said second = run(command(out_, {"--shard", "2/2", "--wait", "60"}));
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(first.finish().exit_code, 0);
  EXPECT_EQ(run(command(out_)).exit_code, 0);
}

TEST_F(Shards, that_make_no_sense_are_wrong_usage) {
  fs::create_directories(scans_);
  for (const char* shard : {"0/3", "4/3", "1", "a/b", "1/0", "1/2/3", "-1/2"}) {
    EXPECT_EQ(run(command(out_, {std::string("--shard=") + shard})).exit_code, 2) << shard;
  }
}

}  // namespace
}  // namespace isthmus::testing
