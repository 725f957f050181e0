// What registering measured, out of the store again.
#include "pipelines/measured_survey.h"

#include <gtest/gtest.h>

#include "base/temporary_folder.h"

namespace isthmus::pipelines {
namespace {

MeasuredSurvey survey_of_one_pair() {
  MeasuredSurvey survey;
  survey.title = "two";
  survey.graph.voxel_m = 0.1;
  for (const int id : {0, 1}) {
    survey.graph.scans.push_back({id, std::string(1, static_cast<char>('a' + id)), Eigen::Vector3d::Zero(), 5});
    report::ScanRecord scan;
    scan.id = id;
    scan.name = survey.graph.scans.back().name;
    scan.seconds = {{"sampled", 1.5}};
    survey.scans.push_back(scan);
  }
  Link link;
  link.source = 1;
  link.result.verdict = Verdict::accepted;
  link.refuted = "the scans around it say no";
  survey.graph.links.push_back(link);
  link.refuted.clear();
  link.by_hand = ByHand::added;
  survey.graph.links.push_back(link);
  return survey;
}

store::Store open_store(const std::filesystem::path& folder) {
  Result<store::Store> store =
      store::Store::open(folder, [](const Error& trouble) { ADD_FAILURE() << trouble.text(); });
  EXPECT_TRUE(store);
  return std::move(*store);
}

TEST(MeasuredSurvey, comes_back_with_what_was_refuted_and_what_was_done_by_hand) {
  const testing::TemporaryFolder folder;
  const store::Store store = open_store(folder / "store");
  const std::optional<MeasuredSurvey> back = load_measured(keep_measured(survey_of_one_pair(), store), store);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->graph.links.size(), 2U);
  EXPECT_EQ(back->graph.links[0].refuted, "the scans around it say no");
  EXPECT_EQ(back->graph.links[0].by_hand, ByHand::nothing);
  EXPECT_EQ(back->graph.links[1].refuted, "");
  EXPECT_EQ(back->graph.links[1].by_hand, ByHand::added);
  EXPECT_EQ(back->scans[1].name, "b");
  EXPECT_EQ(back->scans[1].seconds.size(), 1U);
}

TEST(MeasuredSurvey, is_the_same_however_long_it_took) {
  const testing::TemporaryFolder folder;
  const store::Store store = open_store(folder / "store");
  MeasuredSurvey survey = survey_of_one_pair();
  const std::string digest = keep_measured(survey, store);
  survey.scans[0].seconds = {{"sampled", 0.0}};
  EXPECT_EQ(keep_measured(survey, store), digest);
  survey.graph.links[0].refuted.clear();
  EXPECT_NE(keep_measured(survey, store), digest);
}

}  // namespace
}  // namespace isthmus::pipelines
