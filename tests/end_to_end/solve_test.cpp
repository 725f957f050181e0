// A finished survey is solved again.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "survey_on_disk.h"

namespace isthmus::testing {
namespace {

class SolveAgain : public SurveyOnDisk {
 protected:
  void SetUp() override {
    make_survey(4);
    ASSERT_LE(register_scans().exit_code, 3);
  }
  Said solve(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"solve", out_.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// Names of the first accepted link, source first, and its matrix as text.
  struct Accepted {
    std::string source, target, matrix;
  };
  Accepted first_accepted() {
    std::istringstream links(text_of_file(out_ / "links.csv"));
    std::string line;
    std::vector<std::string> header;
    while (std::getline(links, line)) {
      std::vector<std::string> fields;
      std::string field;
      bool quoted = false;
      for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) {
          fields.push_back(field);
          field.clear();
        } else if (c != '"') {
          field += c;
        }
      }
      fields.push_back(field);
      if (header.empty()) {
        header = fields;
        continue;
      }
      const auto at = [&](const std::string& name) {
        return fields.at(static_cast<std::size_t>(std::ranges::find(header, name) - header.begin()));
      };
      if (at("verdict") != "accepted") continue;
      Accepted link{at("source_name"), at("target_name"), {}};
      for (const char* name : {"r00", "r01", "r02", "tx", "r10", "r11", "r12", "ty", "r20", "r21", "r22", "tz"})
        link.matrix += at(name) + (name[0] == 't' ? "\n" : " ");
      return link;
    }
    ADD_FAILURE() << "no accepted link";
    return {};
  }
};

TEST_F(SolveAgain, without_edits_gives_the_same_bytes_and_reads_no_scan) {
  const fs::path kept = folder_ / "kept";
  fs::copy(out_, kept, fs::copy_options::recursive);
  fs::remove_all(scans_);
  const Said said = solve();
  EXPECT_LE(said.exit_code, 3) << said.err;
  EXPECT_NE(said.out.find("report.html"), std::string::npos);
  expect_same_bytes(out_, kept);
  nlohmann::json before = run_json(kept), after = run_json(out_);
  EXPECT_EQ(after["run"]["survey"], before["run"]["survey"]);
  before.erase("run"), after.erase("run");
  EXPECT_EQ(before, after);
}

/// What the page's 3D view reads; empty where the page has none.
std::string view_data_in(const fs::path& out) {
  const std::string page = text_of_file(out / "report.html"),
                    begin = "<script type=\"application/json\" id=\"view-data\">";
  const std::size_t at = page.find(begin);
  return at == std::string::npos ? std::string() : page.substr(at, page.find("</script>", at) - at);
}

TEST_F(SolveAgain, report_shows_the_scans_in_space_as_long_as_the_store_holds_them) {
  const std::string of_register = view_data_in(out_);
  if (of_register.empty()) GTEST_SKIP() << "this build's report has no view";
  fs::remove_all(scans_);
  ASSERT_LE(solve().exit_code, 3);
  EXPECT_EQ(view_data_in(out_), of_register);

  // The points of two scans are gone, of which one may not be placed; then those of all.
  std::vector<fs::path> sampled;
  for (const auto& entry : fs::recursive_directory_iterator(out_ / "store" / "sampled"))
    if (entry.is_regular_file()) sampled.push_back(entry.path());
  ASSERT_EQ(sampled.size(), 4U);
  for (const std::size_t gone : {0U, 1U}) fs::remove(sampled[gone]);
  Said said = solve();
  ASSERT_LE(said.exit_code, 3);
  EXPECT_NE(said.err.find(" scans have no points in the view of report.html"), std::string::npos) << said.err;
  EXPECT_FALSE(view_data_in(out_).empty());
  for (const fs::path& file : sampled) fs::remove(file);
  said = solve();
  ASSERT_LE(said.exit_code, 3);
  EXPECT_NE(said.err.find("report.html does not show the scans in space: the store does not hold"), std::string::npos)
      << said.err;
  EXPECT_TRUE(view_data_in(out_).empty());
  EXPECT_NE(text_of_file(out_ / "report.html").find("The scans are not shown here: the store does not hold"),
            std::string::npos);
}

TEST_F(SolveAgain, link_is_taken_out_and_added_by_hand_and_the_outputs_say_so) {
  const Accepted link = first_accepted();
  const std::string poses = text_of_file(out_ / "poses.txt");
  ASSERT_LE(solve({"--without-link", link.target, link.source}).exit_code, 3);
  nlohmann::json edits = run_json(out_)["edits"];
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0]["link"], "taken out");
  EXPECT_EQ(edits[0]["source"], link.source);
  EXPECT_NE(text_of_file(out_ / "links.csv").find("taken out by hand (accepted before: "), std::string::npos);
  EXPECT_NE(text_of_file(out_ / "report.html").find("Taken out by hand: "), std::string::npos);

  const std::string matrix = write("t.txt", link.matrix).string();
  ASSERT_LE(
      solve({"--without-link", link.source, link.target, "--add-link", link.source, link.target, matrix}).exit_code, 3);
  edits = run_json(out_)["edits"];
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[1]["link"], "added");
  EXPECT_EQ(edits[1]["verdict"], "accepted");
  EXPECT_NE(text_of_file(out_ / "report.html").find("Added by hand: "), std::string::npos);

  // Every call starts from what was measured.
  ASSERT_LE(solve().exit_code, 3);
  EXPECT_EQ(text_of_file(out_ / "poses.txt"), poses);
  EXPECT_TRUE(run_json(out_)["edits"].empty());
}

TEST_F(SolveAgain, wrong_edits_are_named_and_leave_the_results_alone) {
  const Accepted link = first_accepted();
  const std::string before = text_of_file(out_ / "run.json");
  const auto expect_error = [&](const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    const Said said = solve(arguments);
    EXPECT_EQ(said.exit_code, 1) << said.err;
    for (const std::string& word : words) EXPECT_NE(said.err.find(word), std::string::npos) << word << "\n" << said.err;
  };
  expect_error({"--without-link", link.source, link.target + "x"},
               {link.target + "x", "did you mean " + link.target + "?"});
  expect_error({"--add-link", link.source, link.target, "/no/such.txt"}, {"/no/such.txt"});
  const std::string words = write("words.txt", "1 0 0 zero\n0 1 0 0\n0 0 1 0\n").string();
  expect_error({"--add-link", link.source, link.target, words}, {words, "'zero' is not a finite number"});
  const std::string few = write("few.txt", "1 0 0 0\n").string();
  expect_error({"--add-link", link.source, link.target, few}, {few, "4 numbers, 12 or 16 are wanted"});
  const std::string scaled = write("scaled.txt", "1.1 0 0 0\n0 1.1 0 0\n0 0 1.1 0\n").string();
  expect_error({"--add-link", link.source, link.target, scaled}, {scaled, "not a rigid transform", "1.331"});
  const std::string mirror = write("mirror.txt", "1 0 0 0\n0 1 0 0\n0 0 -1 0\n").string();
  expect_error({"--add-link", link.source, link.target, mirror}, {mirror, "mirrors"});
  expect_error({"--add-link", link.source, link.source, mirror}, {"joins two scans"});
  expect_error({"--set", "sampling.voxel_m=1"}, {"sampling.voxel_m=1", "only settings of 'solve'"});
  EXPECT_EQ(text_of_file(out_ / "run.json"), before);

  EXPECT_NE(run({"solve", "/no/such/out"}).err.find("/no/such/out: there is no such folder"), std::string::npos);
  fs::create_directories(folder_ / "empty");
  EXPECT_NE(run({"solve", (folder_ / "empty").string()}).err.find("run.json is missing"), std::string::npos);
  fs::remove_all(out_ / "store");
  expect_error({}, {"store", "run the same 'isthmus register' again"});
}

TEST_F(SolveAgain, explain_says_why_a_scan_or_a_pair_is_where_it_is) {
  const Accepted link = first_accepted();
  const Said scan = run({"explain", out_.string(), link.source});
  EXPECT_EQ(scan.exit_code, 0) << scan.err;
  EXPECT_NE(scan.out.find(link.source + " is placed in the largest part"), std::string::npos) << scan.out;
  EXPECT_NE(scan.out.find("Links that hold it ("), std::string::npos) << scan.out;
  EXPECT_NE(scan.out.find("accepted " + link.target + ": probability"), std::string::npos) << scan.out;
  const Said pair = run({"explain", out_.string(), link.target, link.source});
  EXPECT_NE(pair.out.find(link.source + " onto " + link.target + ": accepted"), std::string::npos) << pair.out;
  EXPECT_NE(pair.out.find("Evidence: "), std::string::npos) << pair.out;
  EXPECT_NE(pair.out.find("By the solved poses their centres are "), std::string::npos) << pair.out;
  // It tells of the survey as it was solved last.
  ASSERT_LE(solve({"--without-link", link.source, link.target}).exit_code, 3);
  EXPECT_NE(run({"explain", out_.string(), link.source, link.target}).out.find("taken out by hand"), std::string::npos);
  EXPECT_NE(run({"explain", out_.string(), "nonsense"}).err.find("the survey has no scan 'nonsense'"),
            std::string::npos);
}

TEST_F(SolveAgain, control_puts_the_survey_into_the_map) {
  // The simulator's truth, moved to map coordinates, is the map.
  std::istringstream truth(text_of_file(scans_ / "poses.gt.txt"));
  std::string csv = "name,scan,local_x,local_y,local_z,world_x,world_y,world_z,sigma_m\n", line;
  while (std::getline(truth, line)) {
    std::istringstream words(line);
    std::string name;
    std::array<double, 12> m{};
    words >> name;
    for (double& value : m) words >> value;
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(1, 2, 0.5), Eigen::Vector3d(-6, 1, 0.25)}) {
      Eigen::Vector3d world(5e5, 5.2e6, 400);
      for (int row = 0; row < 3; ++row) {
        const double* const r = m.data() + 4 * row;
        world[row] += r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3];
      }
      csv += fmt::format("T{}{},{},{},{},{},{:.6f},{:.6f},{:.6f},0.01\n", name, p[0], name, p[0], p[1], p[2], world[0],
                         world[1], world[2]);
    }
  }
  const std::string control = write("control.csv", csv).string();
  ASSERT_LE(solve({"--control", control}).exit_code, 3);
  const nlohmann::json json = run_json(out_);
  ASSERT_EQ(json["control"].size(), 8U);
  EXPECT_EQ(json["components"][0]["frame"], "world");
  EXPECT_EQ(json["components"][0]["datum_shift_m"][1], 5.2e6);
  const nlohmann::json& placed = json["components"][0]["scans"];
  for (const auto& item : json["control"])
    EXPECT_EQ(item["used"].get<bool>(), std::ranges::find(placed, item["scan"]) != placed.end()) << item;
  std::istringstream poses(text_of_file(out_ / "poses.txt"));
  while (std::getline(poses, line)) {
    std::istringstream words(line);
    std::string name;
    std::array<double, 12> m{};
    words >> name;
    for (double& value : m) words >> value;
    EXPECT_NEAR(m[3], 5e5, 100) << line;
    EXPECT_NEAR(m[7], 5.2e6, 100) << line;
  }
  EXPECT_NE(text_of_file(out_ / "report.html").find("Datum shift 500000 / 5200000 / 400 m"), std::string::npos);

  write("control.csv", csv + "X,nonsense,0,0,0,0,0,0,0.01\n");
  const Said unknown = solve({"--control", control});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("control.csv:10: the survey has no scan 'nonsense'"), std::string::npos) << unknown.err;
  write("control.csv", csv + "X,a,0,0,0,0,zero,0,0.01\n");
  EXPECT_NE(solve({"--control", control}).err.find("control.csv:10: 'zero' under world_y"), std::string::npos);
  const std::string yaml =
      write("control.yaml", "points:\n  - {scan: a, world: [1, 2, 3], sigma_m: 0.1, locl: [1, 2, 3]}\n").string();
  EXPECT_NE(solve({"--control", yaml}).err.find("did you mean local?"), std::string::npos);
}

}  // namespace
}  // namespace isthmus::testing
