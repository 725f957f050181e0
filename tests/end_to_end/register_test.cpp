// From a folder of scans to the files of the output contract.
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

class Register : public SurveyOnDisk {};

TEST_F(Register, places_all_scans_of_a_small_office_and_writes_every_file) {
  make_survey(3);
  const Said said = register_scans();
  ASSERT_EQ(said.exit_code, 0) << said.err;
  for (const std::string& file : kAllFiles) EXPECT_TRUE(fs::exists(out_ / file)) << file;
  const evaluate::Evaluation evaluation = evaluate_out(out_);
  EXPECT_TRUE(evaluation.wrong.empty());
  ASSERT_TRUE(evaluation.poses);
  EXPECT_EQ(evaluation.poses->placed, 3);
  EXPECT_EQ(evaluation.poses->within, 3);
  EXPECT_EQ(run_json(out_)["run"]["exit_code"], 0);
  EXPECT_NE(said.out.find("3 of 3 scans"), std::string::npos) << said.out;
}

TEST_F(Register, goes_on_without_an_unreadable_scan_and_says_so) {
  make_survey(3);
  std::ofstream(scans_ / "broken.ply") << "ply\nformat binary_little_endian 1.0\nelement vertex 10\nproperty float x\n";
  std::ofstream(scans_ / "empty.xyz") << "";
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 3) << said.err;
  EXPECT_NE(said.err.find("broken.ply"), std::string::npos) << said.err;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("broken.ply,failed"), std::string::npos) << table;
  EXPECT_EQ(evaluate_out(out_).poses->placed, 3);
  for (const std::string& file : kAllFiles) EXPECT_TRUE(fs::exists(out_ / file)) << file;
}

TEST_F(Register, all_scans_unreadable_still_writes_every_file) {
  fs::create_directories(scans_);
  std::ofstream(scans_ / "a.ply") << "ply\nformat nonsense 1.0\n";
  std::ofstream(scans_ / "b.ply") << "";
  EXPECT_EQ(register_scans().exit_code, 3);
  for (const std::string& file : kAllFiles) EXPECT_TRUE(fs::exists(out_ / file)) << file;
  EXPECT_EQ(text_of_file(out_ / "poses.txt"), "");
}

TEST_F(Register, a_single_scan_is_one_component) {
  make_survey(1);
  EXPECT_EQ(register_scans().exit_code, 0);
  for (const std::string& file : kAllFiles) EXPECT_TRUE(fs::exists(out_ / file)) << file;
}

TEST_F(Register, takes_one_of_two_formats_of_a_scan_and_names_the_other) {
  make_survey(2);
  std::ofstream(scans_ / "scan_000.xyz") << "0 0 0\n1 1 1\n";
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("scan_000.xyz"), std::string::npos) << said.err;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_EQ(std::ranges::count(table, '\n'), 3) << table;
}

TEST_F(Register, goes_on_when_products_cannot_be_kept) {
  make_survey(2);
  fs::create_directories(out_ / "store");
  for (const char* stage : {"sampled", "pair"}) std::ofstream(out_ / "store" / stage) << "in the way of a folder";
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("what was computed cannot be kept"), std::string::npos) << said.err;
}

TEST_F(Register, the_output_may_be_the_folder_of_the_scans) {
  make_survey(2);
  const std::vector<std::string> arguments = {"register", scans_.string(), "-o", scans_.string()};
  ASSERT_EQ(run(arguments).exit_code, 0);
  const std::string table = text_of_file(scans_ / "scans.csv");
  const Said again = run(arguments);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(text_of_file(scans_ / "scans.csv"), table);
}

TEST_F(Register, works_within_little_memory) {
  make_survey(3);
  EXPECT_EQ(register_scans({"--memory", "0.1"}).exit_code, 0);
}

}  // namespace
}  // namespace isthmus::testing
