// From a folder of scans to the files of the output contract.
#include <cmath>

#include "end_to_end/survey_on_disk.h"
#include "io/scan_reader.h"
#include "io/scan_writer.h"
#include "report/view_script.h"

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
  const auto json = nlohmann::json::parse(text_of_file(out_ / "report.json"));
  EXPECT_EQ(json["counts"]["placed"], 3);
  EXPECT_GT(json["links"].at(0)["share_under_20mm"], 0.1);
  const std::string page = text_of_file(out_ / "report.html");
  if (report::kViewScript[0] == '\0') return;  // built without npm
  const std::string begin = "id=\"view-data\">";
  const std::size_t at = page.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t from = at + begin.size();
  const auto view = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  ASSERT_EQ(view["stations"].size(), 3U);
  for (const auto& station : view["stations"]) {
    EXPECT_GT(station["points"], 5000);
    EXPECT_TRUE(station["intensity"]) << "simulated scans have intensities";
  }
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
  EXPECT_EQ(run_json(out_)["warnings"].at(0), "scan_000.ply: the only scan, there is nothing to join");
  for (const std::string& file : kAllFiles) EXPECT_TRUE(fs::exists(out_ / file)) << file;
}

/// The folder's copy elsewhere gives the same tables.
TEST_F(Register, says_the_same_wherever_the_folder_lies) {
  make_survey(2);
  std::ofstream(scans_ / "broken.ply") << "ply\nformat nonsense 1.0\n";
  std::ofstream(scans_ / "cut.xyz") << "1 2 3\n4 5 6\n7 eight 9\n";
  fs::create_directories(folder_ / "else where");
  fs::copy(scans_, folder_ / "else where" / "copy", fs::copy_options::recursive);
  EXPECT_EQ(register_scans().exit_code, 3);
  const fs::path other = folder_ / "other out";
  EXPECT_EQ(run({"register", (folder_ / "else where" / "copy").string(), "-o", other.string()}).exit_code, 3);
  expect_same_bytes(out_, other);
  EXPECT_EQ(run_json(out_)["warnings"], run_json(other)["warnings"]);
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_EQ(table.find(folder_.path().string()), std::string::npos) << table;
}

TEST_F(Register, a_broken_file_gives_way_to_its_twin) {
  make_survey(2);
  io::PointChunk all;
  ASSERT_TRUE(io::open_scan({scans_ / "scan_000.ply", 0, ""}).value()->read(all, 10'000'000));
  ASSERT_TRUE(io::write_scan(scans_ / "scan_000.xyz", all));
  fs::resize_file(scans_ / "scan_000.ply", fs::file_size(scans_ / "scan_000.ply") / 2);
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 0) << said.err;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("scan_000.xyz,placed"), std::string::npos) << table;
  EXPECT_EQ(table.find("scan_000.ply"), std::string::npos) << table;
  const std::string warning = run_json(out_)["warnings"].at(0);
  EXPECT_TRUE(warning.starts_with("scan_000.ply: cannot be used (")) << warning;
  EXPECT_TRUE(warning.ends_with("), scan_000.xyz is taken for the same scan")) << warning;
  EXPECT_NE(said.err.find(warning), std::string::npos) << said.err;
}

TEST_F(Register, a_scan_in_millimetres_is_named_and_left_out) {
  make_survey(3);
  io::PointChunk all;
  ASSERT_TRUE(io::open_scan({scans_ / "scan_001.ply", 0, ""}).value()->read(all, 10'000'000));
  for (Eigen::Vector3f& p : all.points) p *= 1000;
  ASSERT_TRUE(io::write_scan(scans_ / "scan_001.ply", all));
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 3) << said.err;
  const std::string warning = run_json(out_)["warnings"].at(0);
  EXPECT_TRUE(warning.starts_with("scan_001.ply: its extent is ")) << warning;
  EXPECT_NE(warning.find("looks like millimetres among metres"), std::string::npos) << warning;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("scan_001.ply,failed"), std::string::npos) << table;
  EXPECT_NE(table.find("looks like millimetres"), std::string::npos) << table;
  EXPECT_EQ(text_of_file(out_ / "poses.txt").find("scan_001"), std::string::npos);
}

TEST_F(Register, every_warning_is_in_the_log_in_run_json_and_in_the_report) {
  make_survey(2);
  std::ofstream(scans_ / "a_broken.ply") << "ply\nformat nonsense 1.0\n";
  std::ofstream(scans_ / "scan_000.xyz") << "0 0 0\n1 1 1\n";
  std::ofstream ball(scans_ / "ball.xyz");  // nothing of the office, and no station in its middle
  for (int i = 0; i < 20000; ++i) {
    const double z = 2 * (i + 0.5) / 20000 - 1, a = 2.399963 * i, r = std::sqrt(1 - z * z);
    ball << 40 + 8 * r * std::cos(a) << ' ' << 8 * r * std::sin(a) << ' ' << 8 * z << '\n';
  }
  ball.close();
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 3) << said.err;
  const auto warnings = run_json(out_)["warnings"];
  const std::vector<std::string> starts = {"scan_000.xyz: not used", "a_broken.ply", "ball.xyz: the origin is not",
                                           "ball.xyz: not joined"};
  ASSERT_EQ(warnings.size(), starts.size()) << warnings;
  const std::string report = text_of_file(out_ / "report.html");
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::string warning = warnings[i];
    EXPECT_TRUE(warning.starts_with(starts[i])) << warning;
    EXPECT_NE(said.err.find("warning: " + warning + "\n"), std::string::npos) << warning << "\n" << said.err;
    EXPECT_NE(report.find(warning.substr(0, 20)), std::string::npos) << warning;
  }
  EXPECT_TRUE(run_json(out_)["run"]["warnings"].empty());
}

TEST_F(Register, an_output_that_cannot_be_written_is_refused_before_anything_is_read) {
  make_survey(1);
  std::ofstream(folder_ / "file") << "x";
  for (const std::string& out : {(folder_ / "file").string(), (folder_ / "file" / "out").string(),
                                 std::string("/proc/isthmus"), std::string("/proc/self")}) {
    const Said said = run({"register", scans_.string(), "-o", out});
    EXPECT_EQ(said.exit_code, 1) << out;
    EXPECT_TRUE(said.err.starts_with("error: " + out + ": the output ")) << said.err;
    EXPECT_EQ(said.err.find("looking at scans"), std::string::npos) << said.err;
  }
}

TEST_F(Register, two_runs_do_not_share_an_output) {
  make_survey(3);
  StartedProgram first(ISTHMUS_PROGRAM, {"register", scans_.string(), "-o", out_.string()}, folder_.path());
  ASSERT_TRUE(first.wait_for("looking at scans", 60));
  fs::create_directories(folder_ / "second");
  const Said second =
      run_program(ISTHMUS_PROGRAM, {"register", scans_.string(), "-o", out_.string()}, folder_ / "second");
  EXPECT_EQ(second.exit_code, 1) << second.err;
  EXPECT_NE(second.err.find("another run writes to this folder: process "), std::string::npos) << second.err;
  EXPECT_EQ(first.finish().exit_code, 0);
  EXPECT_FALSE(fs::exists(out_ / ".lock"));
  EXPECT_EQ(register_scans().exit_code, 0);
}

TEST_F(Register, leaves_no_folder_behind_when_there_is_nothing_to_do) {
  fs::create_directories(scans_);
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_NE(said.err.find(scans_.string() + ": no scans found (files are known by their extensions: e57 ptx ply"),
            std::string::npos)
      << said.err;
  EXPECT_FALSE(fs::exists(out_));
}

/// A limit on the size of files stands in for a full disk: the same errors, and no need of a disk to fill.
class SmallDisk : public SurveyOnDisk {
 protected:
  Said register_with_limit(int blocks_of_512_bytes) {
    const std::string command = "ulimit -f " + std::to_string(blocks_of_512_bytes) + "; exec " + ISTHMUS_PROGRAM +
                                " register " + scans_.string() + " -o " + out_.string();
    return run_program("/bin/sh", {"-c", command}, folder_.path());
  }
};

TEST_F(SmallDisk, that_cannot_hold_the_results_is_named_at_once) {
  make_survey(2);
  const Said said = register_with_limit(20);
  EXPECT_EQ(said.exit_code, 1) << said.err;
  EXPECT_NE(said.err.find("error: " + out_.string() + ": there is no space for the results: "), std::string::npos)
      << said.err;
  EXPECT_NE(said.err.find(" kB are needed"), std::string::npos) << said.err;
  EXPECT_EQ(said.err.find("unreadable"), std::string::npos) << said.err;
}

TEST_F(SmallDisk, that_cannot_hold_the_products_costs_time_only) {
  make_survey(2);
  const Said said = register_with_limit(500);  // sampled scans are larger
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("what was computed cannot be kept: cannot be written: File too large"), std::string::npos)
      << said.err;
  EXPECT_EQ(run_json(out_)["run"]["warnings"].size(), 1U);
  EXPECT_TRUE(run_json(out_)["warnings"].empty()) << run_json(out_)["warnings"];
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
