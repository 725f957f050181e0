#include "evaluate/evaluate.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "evaluate/inputs.h"
#include "evaluate/overlap.h"
#include "made_survey.h"

namespace isthmus::evaluate {
namespace {

using isthmus::testing::kEvaluationVoxel;
using isthmus::testing::MadeSurvey;
using isthmus::testing::shifted;

EvaluateOptions options_for(const MadeSurvey& survey) {
  EvaluateOptions options;
  options.truth = survey.scans / "poses.gt.txt";
  return options;
}

TEST(Evaluate, CountsRightAndWrongEdgesByOverlap) {
  const MadeSurvey survey("evaluate_edges", 4);
  Transform turned = survey.truth_of(0, 2);
  turned.linear() = turned.linear() * rotation_from_vector({0, 0, 0.04});  // 2.3 degrees
  survey.write_outputs({{0, 1, shifted(survey.truth_of(0, 1), 0.39)},      // inside two voxels of 0.2 m
                        {1, 2, shifted(survey.truth_of(1, 2), 0.41)},      // outside
                        {0, 2, turned},
                        {2, 3, survey.truth_of(2, 3)}},
                       {}, {0, 0, 0, 0});
  const Result<Evaluation> e = evaluate(survey.out, survey.scans, options_for(survey));
  ASSERT_TRUE(e) << e.error().text();
  EXPECT_EQ(e->voxel_m, kEvaluationVoxel);  // from scans.csv
  EXPECT_EQ(e->edges, 4);
  EXPECT_EQ(e->right, 2);
  ASSERT_EQ(e->wrong.size(), 2U);
  EXPECT_NEAR(e->wrong[0].translation_m, 0.41, 1e-9);
  EXPECT_NEAR(*e->wrong[1].rotation_deg, 2.2918, 1e-3);
  EXPECT_EQ(e->placeable, 4);
  EXPECT_FALSE(e->poses);
  // Neighbours share 6 of 10 metres, the next but one 2 of 10, the outer two nothing.
  ASSERT_FALSE(e->bands.empty());
  EXPECT_EQ(e->bands[0].name, ">30%");
  EXPECT_EQ(e->bands[0].pairs, 3);
  EXPECT_EQ(e->bands[0].found, 2);
  EXPECT_EQ(e->bands.back().name, "<5%");
  EXPECT_EQ(e->bands.back().pairs, 1);
}

TEST(Evaluate, EachComponentHasItsOwnGauge) {
  const MadeSurvey survey("evaluate_poses", 5);
  Transform gauge = Transform::Identity();
  gauge.linear() = rotation_from_vector({0.3, -0.2, 1.0});
  gauge.translation() = Eigen::Vector3d(7, 8, 9);
  const auto& truth = survey.common_from_scan;
  Transform off = truth[2];
  off.translation().y() += 0.5;
  survey.write_outputs({}, {{0, truth[0]}, {1, truth[1]}, {2, off}, {3, gauge * truth[3]}, {4, gauge * truth[4]}},
                       {0, 0, 0, 1, 1});
  const Result<Evaluation> e = evaluate(survey.out, survey.scans, options_for(survey));
  ASSERT_TRUE(e) << e.error().text();
  ASSERT_TRUE(e->poses);
  EXPECT_EQ(e->poses->placed, 5);
  EXPECT_EQ(e->poses->of, 5);
  EXPECT_EQ(e->poses->within, 4);
  EXPECT_EQ(e->poses->components, (std::vector<int>{3, 2}));
  EXPECT_NEAR(e->poses->max_m, 0.5, 1e-9);
  EXPECT_NEAR(e->poses->median_m, 0.0, 1e-9);
}

TEST(Evaluate, UnknownScansAreNamedNotCounted) {
  const MadeSurvey survey("evaluate_unknown", 3);
  survey.write_outputs({{0, 7, survey.truth_of(0, 1)}}, {{0, survey.common_from_scan[0]}}, {0, 0, 0});
  std::ofstream(survey.out / "poses.txt", std::ios::app) << "stranger.ply 1 0 0 0 0 1 0 0 0 0 1 0\n";
  const Result<Evaluation> e = evaluate(survey.out, survey.scans, options_for(survey));
  ASSERT_TRUE(e) << e.error().text();
  ASSERT_EQ(e->wrong.size(), 1U);
  EXPECT_FALSE(e->wrong[0].rotation_deg);
  EXPECT_EQ(e->unknown_placed, std::vector<std::string>{"stranger.ply"});
  const auto json = nlohmann::json::parse(json_of(*e));
  EXPECT_EQ(json["wrong"], 1);
  EXPECT_TRUE(json["poses"].is_null());
  EXPECT_NE(text_of(*e).find("stranger.ply"), std::string::npos);
}

TEST(Evaluate, BrokenInputsAreNamedWithLine) {
  const MadeSurvey survey("evaluate_broken", 2);
  EvaluateOptions options = options_for(survey);
  survey.write_outputs({}, {}, {0, 0});
  std::ofstream(survey.out / "pose_graph.g2o") << "# fine\nEDGE_SE3:QUAT 0 1 0 0 zero 0 0 0 1\n";
  const Result<Evaluation> e = evaluate(survey.out, survey.scans, options);
  ASSERT_FALSE(e);
  EXPECT_NE(e.error().text().find("pose_graph.g2o, line 2"), std::string::npos) << e.error().text();
  options.truth = survey.scans / "nothing.txt";
  EXPECT_FALSE(evaluate(survey.out, survey.scans, options));
}

TEST(Overlap, TwoSidesOfAWallDoNotOverlap) {
  Points wall;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) wall.emplace_back(0.1 * i, 0.0, 0.1 * j);
  Points near = wall, far = wall;
  for (Eigen::Vector3d& p : near) p -= Eigen::Vector3d(1, -2, 1);  // as seen by stations on either side
  for (Eigen::Vector3d& p : far) p -= Eigen::Vector3d(1, 2, 1);
  const Transform at_near(Eigen::Translation3d(1, -2, 1)), at_far(Eigen::Translation3d(1, 2, 1));
  const Surface a = surface_of(near, at_near, 0.1), b = surface_of(far, at_far, 0.1);
  EXPECT_EQ(covered_share(a, b, 0.1), 0.0);
  EXPECT_EQ(covered_share(a, a, 0.1), 1.0);
}

TEST(Inputs, CsvWithQuotesAndLineBreaks) {
  EXPECT_EQ(parse_csv("a,\"b,\"\"c\"\"\nd\"\r\n\ne,f\n"),
            (std::vector<std::vector<std::string>>{{"a", "b,\"c\"\nd"}, {"e", "f"}}));
  EXPECT_EQ(file_name_of("sub%20dir/a%20b.ply#2"), "a b.ply#2");
}

}  // namespace
}  // namespace isthmus::evaluate
