#include "pipelines/survey_warnings.h"

#include <gtest/gtest.h>

#include "report/sample_record.h"

namespace isthmus::pipelines {
namespace {

using Strings = std::vector<std::string>;

/// Scans named a, b, c ... that nothing joins.
report::SurveyRecord apart(int count) {
  report::SurveyRecord record;
  for (int id = 0; id < count; ++id) {
    report::ScanRecord scan;
    scan.id = id;
    scan.name = std::string(1, static_cast<char>('a' + id));
    record.scans.push_back(scan);
    record.solution.scans.push_back({id, id, Transform::Identity(), {}, {}, {}});
    record.solution.components.push_back({id, {id}, {}});
  }
  return record;
}

TEST(SurveyWarnings, equal_notes_of_several_scans_are_one_and_matters_of_course_none) {
  report::SurveyRecord record = apart(7);
  record.solution.components = {{0, {0, 1, 2, 3, 4, 5, 6}, {}}};
  for (report::ScanRecord& scan : record.scans) scan.notes = {"LAS 1.2, point format 3", "station unknown"};
  record.scans[2].notes.emplace_back("odd header");
  EXPECT_EQ(survey_warnings(record), (Strings{"a, b, c, d, e and 2 more: station unknown", "c: odd header"}));
}

TEST(SurveyWarnings, what_hangs_apart_is_named) {
  report::SurveyRecord record = apart(6);
  record.solution.components = {{0, {0, 3, 5}, {}}, {1, {1, 4}, {}}, {2, {2}, {}}};
  EXPECT_EQ(survey_warnings(record),
            (Strings{"b, e: a part of 2 scans that hangs together, but not with the largest part",
                     "c: not joined to any other scan"}));
  EXPECT_EQ(survey_warnings(apart(3)), Strings{"a, b, c: not joined to any other scan"});
  EXPECT_EQ(survey_warnings(apart(1)), Strings{"a: the only scan, there is nothing to join"});
  EXPECT_EQ(survey_warnings({}), Strings{});
}

TEST(SurveyWarnings, pairs_that_failed_are_named_with_the_reason) {
  report::SurveyRecord record = apart(3);
  record.solution.components = {{0, {0, 1, 2}, {}}};
  for (const auto& [source, target] : {std::pair(1, 0), std::pair(2, 0), std::pair(2, 1)}) {
    SolvedLink solved;
    solved.link.source = source;
    solved.link.target = target;
    solved.link.result.reason = "no keypoints";
    if (target == 1) solved.link.result.verdict = Verdict::rejected;
    record.solution.links.push_back(solved);
  }
  EXPECT_EQ(survey_warnings(record), Strings{"b with a, c with a: the pair failed: no keypoints"});
}

}  // namespace
}  // namespace isthmus::pipelines
