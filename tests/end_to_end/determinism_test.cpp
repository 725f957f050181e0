// The same bytes for any number of threads, any order of the files, any names of the folders.
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

class Determinism : public SurveyOnDisk {};

TEST_F(Determinism, the_same_bytes_with_1_2_and_7_threads_and_with_the_files_in_another_order) {
  make_survey(4);
  std::ofstream(scans_ / "broken.ply") << "ply\nformat nonsense 1.0\n";
  for (const std::string threads : {"1", "2", "7"}) {
    const std::string out = (folder_ / ("out" + threads)).string();
    ASSERT_EQ(run({"register", scans_.string(), "-o", out, "--threads", threads}).exit_code, 3);
  }
  expect_same_bytes(folder_ / "out1", folder_ / "out2");
  expect_same_bytes(folder_ / "out1", folder_ / "out7");

  std::vector<std::string> reversed = {"register"};
  for (const char* name : {"scan_003.ply", "scan_001.ply", "broken.ply", "scan_002.ply", "scan_000.ply"}) {
    reversed.push_back((scans_ / name).string());
  }
  reversed.insert(reversed.end(), {"-o", (folder_ / "reversed").string(), "--threads", "2"});
  ASSERT_EQ(run(reversed).exit_code, 3);
  expect_same_bytes(folder_ / "out1", folder_ / "reversed");

  // Everything but the section `run` of run.json, too.
  nlohmann::json one = run_json(folder_ / "out1"), seven = run_json(folder_ / "out7");
  one.erase("run");
  seven.erase("run");
  EXPECT_EQ(one.dump(), seven.dump());
}

}  // namespace
}  // namespace isthmus::testing
