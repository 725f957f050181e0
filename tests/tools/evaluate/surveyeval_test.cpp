// Agreement with the independent evaluator, where it is at hand.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/rng.h"
#include "evaluate/evaluate.h"
#include "evaluate/inputs.h"
#include "evaluate/overlap.h"
#include "made_survey.h"

namespace isthmus::evaluate {
namespace {

using isthmus::testing::MadeSurvey;
using isthmus::testing::shifted;

std::filesystem::path shared() {
  const char* folder = std::getenv("ISTHMUS_SHARED");
  return folder != nullptr ? std::filesystem::path(folder) : std::filesystem::path(ISTHMUS_SOURCE_DIR) / "../shared";
}

/// Standard output of a command, or nullopt if it failed.
std::optional<std::string> output_of(const std::string& command) {
  FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), n);
  return ::pclose(pipe) == 0 ? std::optional(text) : std::nullopt;
}

class AgreesWithSurveyeval : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(script_))
      GTEST_SKIP() << "no " << script_ << ": set ISTHMUS_SHARED to the shared folder";
    if (!output_of("/usr/bin/python3 -c 'import scipy'"))
      GTEST_SKIP() << "/usr/bin/python3 has no scipy: apt-get install python3-scipy";
  }
  [[nodiscard]] std::string python(const std::string& arguments) const {
    return "/usr/bin/python3 " + script_.string() + ' ' + arguments;
  }

  std::filesystem::path script_ = shared() / "tools/surveyeval.py";
};

void expect_same_overlaps(const Overlaps& ours, const Overlaps& theirs) {
  ASSERT_EQ(ours.of.size(), theirs.of.size());
  // Theirs are rounded to four digits; normals of points without a unique plane may turn either way.
  for (const auto& [pair, overlap] : theirs.of)
    EXPECT_NEAR(ours.of.at(pair), overlap, 0.003) << pair.first << ' ' << pair.second;
}

void expect_same_scores(const Evaluation& ours, const nlohmann::json& theirs) {
  EXPECT_EQ(ours.edges, theirs["edges"].get<int>());
  EXPECT_EQ(ours.right, theirs["right"].get<int>());
  EXPECT_EQ(static_cast<int>(ours.wrong.size()), theirs["wrong"].get<int>());
  EXPECT_EQ(ours.placeable, theirs["placeable"].get<int>());
  for (const Band& band : ours.bands)
    EXPECT_EQ(theirs["recall_by_overlap"].value(band.name, ""), fmt::format("{}/{}", band.found, band.pairs));
  EXPECT_EQ(ours.bands.size(), theirs["recall_by_overlap"].size());
  ASSERT_EQ(ours.poses.has_value(), !theirs["poses"].is_null());
  if (!ours.poses) return;
  const nlohmann::json& poses = theirs["poses"];
  EXPECT_EQ(ours.poses->placed, poses["placed"].get<int>());
  EXPECT_EQ(ours.poses->of, poses["of"].get<int>());
  EXPECT_EQ(ours.poses->within, poses["within"].get<int>());
  EXPECT_EQ(ours.poses->components, poses["components"].get<std::vector<int>>());
  EXPECT_NEAR(ours.poses->median_deg, poses["med_deg"].get<double>(), 1e-4);
  EXPECT_NEAR(ours.poses->median_m, poses["med_m"].get<double>(), 1e-5);
  EXPECT_NEAR(ours.poses->max_deg, poses["max_deg"].get<double>(), 1e-4);
  EXPECT_NEAR(ours.poses->max_m, poses["max_m"].get<double>(), 1e-5);
}

TEST_F(AgreesWithSurveyeval, OnAMadeSurvey) {
  const MadeSurvey survey("evaluate_against_surveyeval", 6);
  ASSERT_TRUE(
      output_of(python(fmt::format("overlaps {} {}", survey.scans.string(), isthmus::testing::kEvaluationVoxel))));
  const auto theirs = read_overlaps(survey.scans / "overlaps.gt.txt");
  ASSERT_TRUE(theirs);
  const auto truth = read_poses(survey.scans / "poses.gt.txt");
  const auto ours = compute_overlaps(survey.scans, *truth, *theirs->voxel_m);
  ASSERT_TRUE(ours);
  expect_same_overlaps(*ours, *theirs);

  Rng rng(9);
  std::vector<MadeSurvey::Edge> edges;
  for (int i = 0; i < 6; ++i)
    for (int j = i + 1; j < 6; ++j) edges.push_back({i, j, shifted(survey.truth_of(i, j), rng.uniform(0, 0.6))});
  std::vector<std::pair<int, Transform>> poses;
  for (int i = 0; i < 5; ++i) poses.emplace_back(i, shifted(survey.common_from_scan[i], rng.uniform(-0.5, 0.5)));
  survey.write_outputs(edges, poses, {0, 0, 0, 1, 1, -1});
  EvaluateOptions options;
  options.truth = survey.scans / "poses.gt.txt";
  options.overlaps = survey.scans / "overlaps.gt.txt";
  const Result<Evaluation> mine = evaluate(survey.out, survey.scans, options);
  ASSERT_TRUE(mine) << mine.error().text();
  EXPECT_GT(mine->wrong.size(), 0U);
  EXPECT_GT(mine->right, 0);
  const auto text = output_of(python(fmt::format("graph {} {}", survey.scans.string(), survey.out.string())));
  ASSERT_TRUE(text);
  expect_same_scores(*mine, nlohmann::json::parse(text->substr(0, text->find('\n'))));
}

TEST_F(AgreesWithSurveyeval, OnOverlapsOfRealScans) {
  for (const char* name : {"fragments_redkitchen", "tls_eth_facade"}) {
    const std::filesystem::path folder = shared() / "data" / name;
    if (!std::filesystem::exists(folder / "overlaps.gt.txt")) GTEST_SKIP() << "no " << folder;
    const auto theirs = read_overlaps(folder / "overlaps.gt.txt");
    const auto truth = read_poses(*truth_beside(folder));
    ASSERT_TRUE(theirs && truth);
    const auto ours = compute_overlaps(folder, *truth, *theirs->voxel_m);
    ASSERT_TRUE(ours) << ours.error().text();
    expect_same_overlaps(*ours, *theirs);
  }
}

}  // namespace
}  // namespace isthmus::evaluate
