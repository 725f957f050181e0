// kill -9 at any moment: the next run ends with the same bytes, and only what was in flight is done twice.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>

#include "base/rng.h"
#include "end_to_end/survey_on_disk.h"
#include "store/journal.h"

namespace isthmus::testing {
namespace {

constexpr int kThreads = 2;
constexpr std::size_t kMostInFlight =
    2 * kThreads;  // items that pass the gate together (docs/decisions/bytes_in_flight.md)

/// ISTHMUS_KILLS, else 2: tools/test.sh asks for 5, tools/full_check.sh for 30.
int num_kills() {
  const char* text = std::getenv("ISTHMUS_KILLS");
  return text != nullptr ? std::atoi(text) : 2;
}

class Killed : public SurveyOnDisk {
 protected:
  std::vector<std::string> command(const fs::path& out) const {
    return {"register",  scans_.string(),
            "-o",        out.string(),
            "--threads", std::to_string(kThreads),
            "--set",     "sampling.target_points=4000",
            "--set",     "candidates.all_pairs_up_to=2",
            "--set",     "candidates.pairs_per_scan=2",
            "--set",     "candidates.file_order_neighbours=1",
            "--set",     "pair.max_hypotheses=20",
            "--set",     "pair.fine_hypotheses=4",
            "--set",     "pair.max_ranked_seeds=20"};
  }
  static std::size_t number(const fs::path& out, const std::string& key) {
    return std::stoul(run_json(out)["run"][key].get<std::string>());
  }
  /// Files of the four stages whose making is counted.
  static std::size_t num_kept(const fs::path& out) {
    std::size_t count = 0;
    for (const char* stage : {"sampled", "features", "regions", "pair"}) {
      std::error_code error;
      for (fs::recursive_directory_iterator entry(out / "store" / stage, error), end; !error && entry != end; ++entry) {
        count += entry->path().extension() == ".artifact" ? 1 : 0;
      }
    }
    return count;
  }
};

TEST_F(Killed, at_random_moments_it_goes_on_to_the_same_bytes_and_repeats_only_what_was_in_flight) {
  make_survey(12);
  const auto start = std::chrono::steady_clock::now();
  const fs::path whole = folder_ / "whole";
  const Said first = run(command(whole));
  ASSERT_TRUE(first.exit_code == 0 || first.exit_code == 3) << first.err;
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  const std::size_t all = number(whole, "products_made");
  ASSERT_GT(all, 12U * 3 + 11);

  Rng rng(20261127);
  int killed_at_work = 0;
  for (int kill = 0; kill < num_kills(); ++kill) {
    const fs::path out = folder_ / ("out" + std::to_string(kill));
    StartedProgram program(ISTHMUS_PROGRAM, command(out), folder_.path());
    std::this_thread::sleep_for(duration * rng.uniform());
    program.signal(SIGKILL);
    const int code = program.finish().exit_code;
    ASSERT_TRUE(code == 128 + SIGKILL || code == first.exit_code) << code;
    const std::size_t kept = num_kept(out);
    const std::vector<store::ProcessJournal> journals = store::read_journals(out / "journal");
    const std::size_t began = journals.empty() ? 0 : journals[0].count("began");
    killed_at_work += began > 0 && kept < all ? 1 : 0;
    EXPECT_LE(began, kept + kMostInFlight) << "kill " << kill << ": more was in flight than the gate lets in";

    const Said said = run(command(out));
    ASSERT_EQ(said.exit_code, first.exit_code) << said.err;
    EXPECT_EQ(said.err.find("damaged"), std::string::npos) << said.err;
    expect_same_bytes(whole, out);
    EXPECT_EQ(number(out, "products_made"), all - kept) << "kill " << kill;
    const std::size_t twice = began + number(out, "products_made") - all;
    EXPECT_LE(twice, kMostInFlight) << "kill " << kill;
    for (const auto& entry : fs::recursive_directory_iterator(out)) {
      const std::string name = entry.path().filename().string();
      if (code == 128 + SIGKILL && name.find(".tmp-") != std::string::npos) continue;  // what 'isthmus clean' is for
      EXPECT_EQ(name.find(".tmp-"), std::string::npos) << entry.path();
    }
    fs::remove_all(out);
    RecordProperty("kill_" + std::to_string(kill),
                   std::to_string(kept) + " of " + std::to_string(all) + " kept, " + std::to_string(twice) + " twice");
    std::printf("kill %d: %zu of %zu products kept, %zu made twice\n", kill, kept, all, twice);
  }
  EXPECT_GE(killed_at_work, num_kills() / 2) << "the moments were not in the work";
}

}  // namespace
}  // namespace isthmus::testing
