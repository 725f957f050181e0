#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "report/csv.h"
#include "report/html_report.h"
#include "report/loop_closures.h"
#include "report/pose_files.h"
#include "report/report_json.h"
#include "report/run_json.h"
#include "report/sample_record.h"
#include "report/tables.h"
#include "report/write_outputs.h"

namespace isthmus::report {
namespace {

using isthmus::testing::exp_of;
using isthmus::testing::random_pose;
using isthmus::testing::sample_record;

/// A small reader as stupid as the standard allows.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '"' && i + 1 < text.size() && text[i + 1] == '"')
        rows.back().back() += '"', ++i;
      else if (c == '"')
        quoted = false;
      else
        rows.back().back() += c;
    } else if (c == '"')
      quoted = true;
    else if (c == ',')
      rows.back().emplace_back();
    else if (c == '\n')
      rows.emplace_back(1);
    else
      rows.back().back() += c;
  }
  rows.pop_back();
  return rows;
}

Transform read_pose(std::istream& in) {
  double x, y, z, qx, qy, qz, qw;
  in >> x >> y >> z >> qx >> qy >> qz >> qw;
  Transform t = Transform::Identity();
  t.translation() = Eigen::Vector3d(x, y, z);
  t.linear() = Eigen::Quaterniond(qw, qx, qy, qz).toRotationMatrix();
  return t;
}

struct G2o {
  struct Edge {
    int from, to;
    Transform measurement;
    Matrix6d information;
  };
  std::map<int, Transform> vertices;
  std::vector<Edge> edges;
};

G2o parse_g2o(const std::string& text) {
  G2o g;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string tag;
    in >> tag;
    if (tag == "VERTEX_SE3:QUAT") {
      int id = 0;
      in >> id;
      g.vertices[id] = read_pose(in);
    } else {
      EXPECT_EQ(tag, "EDGE_SE3:QUAT");
      G2o::Edge e;
      in >> e.from >> e.to;
      e.measurement = read_pose(in);
      for (int r = 0; r < 6; ++r)
        for (int c = r; c < 6; ++c) in >> e.information(r, c), e.information(c, r) = e.information(r, c);
      EXPECT_FALSE(in.fail());
      g.edges.push_back(e);
    }
  }
  return g;
}

/// g2o's EdgeSE3 error: translation and vector part of the unit quaternion (w >= 0) of measurement^-1 * from^-1 * to.
Vector6d g2o_error(const Transform& measurement, const Transform& from, const Transform& to) {
  const Transform delta = measurement.inverse() * from.inverse() * to;
  Eigen::Quaterniond q(delta.linear());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  Vector6d e;
  e << delta.translation(), q.vec();
  return e;
}

TEST(Csv, QuotesWhatRfc4180AsksFor) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"hi\""), "\"say \"\"hi\"\"\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
  CsvTable csv;
  csv.add("x,\"y\"").add(-0.0).add(1.0 / 0.0).add(3).end_row();
  EXPECT_EQ(csv.text(), "\"x,\"\"y\"\"\",0,,3\n");
}

TEST(Outputs, ScansTableHasEveryScanAndTheFailedOneToo) {
  const SurveyRecord record = sample_record(14);
  const auto rows = parse_csv(scans_csv(record));
  ASSERT_EQ(rows.size(), 16U);
  EXPECT_EQ(std::vector<std::string>(rows[0].begin(), rows[0].begin() + 5),
            (std::vector<std::string>{"id", "name", "status", "component", "points"}));
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[1][2], "placed");
  EXPECT_EQ(rows[1][3], "0");
  EXPECT_EQ(rows[13][2], "unplaced");
  EXPECT_NE(rows[13][5].find("slides along the facade"), std::string::npos);
  EXPECT_EQ(rows[15][2], "failed");
  EXPECT_EQ(rows[15][3], "");
  EXPECT_NE(rows[15][5].find("\"4800000\" were promised"), std::string::npos);
}

TEST(Outputs, LinksTableHasEveryPairWithEvidenceButNoTimings) {
  SurveyRecord record = sample_record(14);
  const std::string before = links_csv(record);
  const auto rows = parse_csv(before);
  ASSERT_EQ(rows.size(), record.solution.links.size() + 1);
  EXPECT_EQ(std::vector<std::string>(rows[0].begin(), rows[0].begin() + 7),
            (std::vector<std::string>{"source", "target", "verdict", "reason", "probability", "overlap", "rms_m"}));
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[0][rows[0].size() - 5], "support");
  for (SolvedLink& l : record.solution.links) l.link.result.seconds_by_stage = {{"hypotheses", 9.0}};
  EXPECT_EQ(links_csv(record), before);
  EXPECT_NE(timings_csv(record).find("hypotheses,9"), std::string::npos);
}

TEST(Outputs, PosesAreInTheFilesOwnCoordinates) {
  SurveyRecord record = sample_record(14);
  Rng rng(3);
  for (ScanRecord& scan : record.scans)
    scan.local_origin_in_scan =
        Eigen::Vector3d(500000 + rng.uniform(0, 50), 5240000 + rng.uniform(0, 50), rng.uniform(0, 500));
  std::istringstream lines(poses_text(record));
  std::map<std::string, Transform> poses;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string name;
    in >> name;
    Transform t = Transform::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) in >> t(r, c);
    EXPECT_FALSE(in.fail());
    poses[name] = t;
  }
  EXPECT_EQ(poses.size(), 12U);
  const int anchor = record.solution.components[0].anchor;
  EXPECT_TRUE(poses.at(find_scan(record, anchor)->name).isApprox(Transform::Identity(), 0));
  // A point goes the same way through local frames as through the file's coordinates.
  const ScanRecord& scan = record.scans[5];
  const Eigen::Vector3d p_in_local(3, -2, 1);
  const Eigen::Vector3d by_local =
      record.solution.find(5)->component_from_local * p_in_local + find_scan(record, anchor)->local_origin_in_scan;
  const Eigen::Vector3d by_file = poses.at(scan.name) * (p_in_local + scan.local_origin_in_scan);
  EXPECT_LT((by_local - by_file).norm(), 1e-6);
}

TEST(Outputs, G2oEdgesAgreeWithVerticesInScanFrames) {
  SurveyRecord record = sample_record(14);
  Rng rng(3);
  for (ScanRecord& scan : record.scans)
    scan.local_origin_in_scan = Eigen::Vector3d(rng.uniform(0, 90), rng.uniform(0, 90), 7);
  const G2o g = parse_g2o(pose_graph_g2o(record));
  EXPECT_EQ(g.vertices.size(), 12U);
  EXPECT_EQ(g.edges.size(), static_cast<std::size_t>(count(record).accepted));
  for (const G2o::Edge& e : g.edges) {
    ASSERT_TRUE(g.vertices.contains(e.from) && g.vertices.contains(e.to));
    const Vector6d error = g2o_error(e.measurement, g.vertices.at(e.from), g.vertices.at(e.to));
    EXPECT_LT(error.tail<3>().norm(), 0.01);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(e.information).eigenvalues().minCoeff(), 0);
  }
}

/// The information convention, proven: the cost that g2o computes from our file equals the cost that the solver
/// meant, d' I d for target_from_source * exp(d) between local frames, for every small d, with every cross term.
TEST(Outputs, G2oInformationMeansWhatTheSolverMeant) {
  Rng rng(8);
  for (int trial = 0; trial < 20; ++trial) {
    SurveyRecord record = sample_record(4);
    record.solution.links.resize(1);
    Link& link = record.solution.links[0].link;
    link.result.verdict = Verdict::accepted;
    Matrix6d a;
    for (double& value : a.reshaped()) value = rng.normal();
    record.solution.links[0].information_used = a.transpose() * a;
    link.result.target_from_source = random_pose(rng, 20);
    for (ScanRecord& scan : record.scans)
      scan.local_origin_in_scan = Eigen::Vector3d(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)),
      scan.status = ScanStatus::unplaced;
    const G2o g = parse_g2o(pose_graph_g2o(record));
    ASSERT_EQ(g.edges.size(), 1U);
    EXPECT_EQ(g.edges[0].from, link.target);
    EXPECT_EQ(g.edges[0].to, link.source);
    const Eigen::Translation3d source_origin(find_scan(record, link.source)->local_origin_in_scan);
    const Eigen::Translation3d target_origin(find_scan(record, link.target)->local_origin_in_scan);
    // J: change of g2o's error by a right perturbation of the *local* measurement, by central differences.
    constexpr double kStep = 1e-6;
    Matrix6d jacobian;
    for (int k = 0; k < 6; ++k) {
      const auto error_at = [&](double step) {
        Vector6d d = Vector6d::Zero();
        d[k] = step;
        const Transform moved =
            target_origin * Transform(*link.result.target_from_source * exp_of(d)) * source_origin.inverse();
        return g2o_error(g.edges[0].measurement, Transform::Identity(), moved);
      };
      jacobian.col(k) = (error_at(kStep) - error_at(-kStep)) / (2 * kStep);
    }
    const Matrix6d meant = jacobian.transpose() * g.edges[0].information * jacobian;
    const Matrix6d& used = record.solution.links[0].information_used;
    EXPECT_LT((meant - used).norm(), 1e-5 * used.norm());
  }
}

TEST(Outputs, RunJsonKeepsWhatVariesInOneSection) {
  SurveyRecord record = sample_record(14);
  auto first = nlohmann::json::parse(run_json(record));
  EXPECT_EQ(first["counts"]["scans"], 15);
  EXPECT_EQ(first["counts"]["placed"], 12);
  EXPECT_EQ(first["components"][0]["scans"].size(), 12U);
  EXPECT_EQ(first["versions"]["isthmus"], "0.1.0");
  record.run.seconds = 999;
  record.run.threads = 64;
  auto second = nlohmann::json::parse(run_json(record));
  EXPECT_NE(first, second);
  first.erase("run"), second.erase("run");
  EXPECT_EQ(first, second);
  record.scans[0].name = "broken\xff name";
  EXPECT_FALSE(nlohmann::json::parse(run_json(record)).is_discarded());
}

/// Four scans on a square of 10 m, each side a link; the second side is off by 30 cm along x and 3 degrees about its
/// source's centre.
SurveyRecord square_with_one_bad_side() {
  SurveyRecord record;
  for (int id = 0; id < 4; ++id) {
    ScanRecord scan;
    scan.id = id;
    scan.centre = Eigen::Vector3d(1, 2, 0);
    record.scans.push_back(scan);
  }
  const std::array<Eigen::Vector3d, 4> stations = {{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}}};
  for (int id = 0; id < 4; ++id) {
    SolvedLink l;
    l.link.source = id;
    l.link.target = (id + 1) % 4;
    l.link.result.verdict = Verdict::accepted;
    Transform t = Transform::Identity();
    t.translation() = stations[l.link.source] - stations[l.link.target];
    if (id == 1) {
      const Eigen::Vector3d& centre = record.scans[1].centre;
      t = t * Eigen::Translation3d(0.3, 0, 0) * Eigen::Translation3d(centre) *
          Eigen::AngleAxisd(0.0524, Eigen::Vector3d::UnitZ()) * Eigen::Translation3d(-centre);
    }
    l.link.result.target_from_source = t;
    record.solution.links.push_back(l);
  }
  return record;
}

TEST(LoopClosures, ABadLinkMissesByWhatItIsOff) {
  const SurveyRecord record = square_with_one_bad_side();
  const LoopClosures loops(record);
  const auto bad = loops.of(record.solution.links[1].link);
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->via, (std::vector<int>{0, 3}));
  EXPECT_NEAR(bad->translation_m, 0.3, 1e-9);
  EXPECT_NEAR(bad->rotation_rad, 0.0524, 1e-9);
}

TEST(LoopClosures, BridgesAndRejectedLinksMakeNoLoop) {
  SurveyRecord record = square_with_one_bad_side();
  record.solution.links[2].link.result.verdict = Verdict::rejected;
  const LoopClosures loops(record);
  EXPECT_FALSE(loops.of(record.solution.links[1].link)) << "what is left is a chain";
  const auto rejected = loops.of(record.solution.links[2].link);
  ASSERT_TRUE(rejected) << "a rejected link is judged by the accepted ones";
  EXPECT_EQ(rejected->via, (std::vector<int>{1, 0}));
}

TEST(LoopClosures, TheDirectNeighbourIsTheShortestWay) {
  SurveyRecord record = square_with_one_bad_side();
  SolvedLink diagonal = record.solution.links[0];
  diagonal.link.source = 2;
  diagonal.link.target = 0;
  diagonal.link.result.target_from_source->translation() = Eigen::Vector3d(10, 10, 0);
  record.solution.links.push_back(diagonal);
  const LoopClosures loops(record);
  EXPECT_EQ(loops.of(record.solution.links[3].link)->via, (std::vector<int>{2}));
  EXPECT_NEAR(loops.of(record.solution.links[3].link)->translation_m, 0, 1e-9);
}

TEST(Outputs, ReportJsonSaysWhatThePageSays) {
  SurveyRecord record = sample_record(14);
  const auto json = nlohmann::json::parse(report_json(record));
  EXPECT_EQ(json["verdict"]["grade"], "partly");
  EXPECT_EQ(json["verdict"]["headline"], "12 of 15 scans stand in one survey.");
  ASSERT_EQ(json["scans"].size(), 15U);
  EXPECT_TRUE(json["scans"][14]["pose"].is_null());
  EXPECT_EQ(json["scans"][14]["status"], "failed");
  ASSERT_EQ(json["links"].size(), record.solution.links.size());
  std::size_t loops = 0;
  for (std::size_t k = 0; k < json["links"].size(); ++k) {
    const auto& link = json["links"][k];
    const PairResult& r = record.solution.links[k].link.result;
    EXPECT_DOUBLE_EQ(link["overlap"], r.overlap);
    EXPECT_DOUBLE_EQ(link["rms_m"], r.rms_m);
    for (const char* name : {"share_under_6mm", "share_under_20mm", "observability"}) {
      const std::optional<double> term = evidence_term(r, name);
      EXPECT_EQ(link[name], term ? nlohmann::json(*term) : nlohmann::json(nullptr)) << name;
    }
    EXPECT_EQ(link["verdict"], word(r.verdict));
    loops += link["loop"].is_null() ? 0 : 1;
  }
  EXPECT_GT(loops, 0U);
  // Two scans hang apart; each says which link came nearest.
  ASSERT_EQ(json["components"].size(), 3U);
  EXPECT_EQ(json["components"][1]["nearest_to_joining"]["reason"], "slides along the facade");
  int binned = 0;
  for (const char* verdict : {"accepted", "ambiguous", "rejected"})
    for (const int n : json["histograms"]["overlap"][verdict]) binned += n;
  EXPECT_EQ(binned, count(record).pairs - count(record).pairs_failed);
  EXPECT_DOUBLE_EQ(json["seconds_by_stage"]["read"], 14 * 1.2);
  EXPECT_EQ(json["run"]["threads"], 2);
  record.scans[0].name = "broken\xff name";
  EXPECT_FALSE(nlohmann::json::parse(report_json(record)).is_discarded());
}

TEST(Outputs, ReportJsonSaysWhatWasDoneByHand) {
  SurveyRecord record = sample_record(14);
  EXPECT_TRUE(nlohmann::json::parse(report_json(record))["edits"].empty());
  Link& link = record.solution.links[0].link;
  link.by_hand = ByHand::taken_out;
  link.result.verdict = Verdict::rejected;
  const auto json = nlohmann::json::parse(report_json(record));
  ASSERT_EQ(json["edits"].size(), 1U);
  EXPECT_EQ(json["edits"][0]["source"], find_scan(record, link.source)->name);
  EXPECT_EQ(json["links"][0]["by_hand"], "taken out");
  const std::string summary = json["verdict"]["summary"];
  EXPECT_NE(summary.find("Taken out by hand: "), std::string::npos);
  EXPECT_EQ(summary.back(), '.');
  EXPECT_NE(html_report(record).find("Taken out by hand: "), std::string::npos);
}

TEST(Html, EveryLinkIsMarkedInTableMapAndMatrix) {
  const SurveyRecord record = sample_record(14);
  const std::string page = html_report(record);
  const auto times = [&](const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) ++n;
    return n;
  };
  const SolvedLink& first = record.solution.links.front();
  ASSERT_EQ(first.link.result.verdict, Verdict::accepted);
  // Row, line of the plan, and both halves of the matrix.
  EXPECT_EQ(times(fmt::format("data-link=\"{}-{}\"", first.link.source, first.link.target)), 4U);
  EXPECT_EQ(times("data-scan=\"3\""), 3U) << "row, station, diagonal";
  EXPECT_NE(page.find("&lt; 6 mm"), std::string::npos);
}

TEST(Outputs, EmptySurveyStillGivesEveryFile) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "isthmus_empty_outputs";
  std::filesystem::remove_all(folder);
  const Result<void> written = write_outputs(SurveyRecord{}, folder);
  ASSERT_TRUE(written) << written.error().text();
  for (const char* name : {"scans.csv", "poses.txt", "pose_graph.g2o", "links.csv", "timings.csv", "run.json",
                           "report.html", "report.json"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  EXPECT_EQ(*read_file(folder / "poses.txt"), "");
  EXPECT_NE(read_file(folder / "report.html")->find("No scan was found."), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Html, IsSelfContainedAndEscapesNames) {
  const SurveyRecord record = sample_record(20);
  const std::string page = html_report(record);
  for (const char* forbidden : {"http://", "https://", "src=", "@import", "url("})
    EXPECT_EQ(page.find(forbidden), std::string::npos) << forbidden;
  EXPECT_EQ(page.find("<quarter>"), std::string::npos);
  EXPECT_NE(page.find("Old town &lt;quarter&gt;"), std::string::npos);
  EXPECT_NE(page.find("18 of 21 scans stand in one survey."), std::string::npos);
  EXPECT_NE(page.find("slides along the facade"), std::string::npos);
  EXPECT_EQ(page, html_report(record));
  if (const char* folder = std::getenv("ISTHMUS_KEEP_REPORTS")) {
    for (const int n : {8, 20, 100}) {
      std::ofstream(std::filesystem::path(folder) / fmt::format("report_{}.html", n)) << html_report(sample_record(n));
    }
  }
}

}  // namespace
}  // namespace isthmus::report
