// Real scans, turned at random by the independent evaluator so that nothing can be read off their frames. They do not
// come with the repo: ISTHMUS_SHARED, else the folder shared/ beside it.
#include <cstdlib>

#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

struct Case {
  std::string set;
  std::string mode;  ///< how surveyeval.py turns the scans
  int least_within;  ///< poses within 1 degree and 2 evaluation voxels
  bool connected;    ///< all scans in one component
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.set << " " << c.mode; }

class SharedSurvey : public SurveyOnDisk, public ::testing::WithParamInterface<Case> {};

fs::path shared_folder() {
  const char* named = std::getenv("ISTHMUS_SHARED");
  return named != nullptr ? fs::path(named) : fs::path(ISTHMUS_SOURCE_DIR) / ".." / "shared";
}

TEST_P(SharedSurvey, is_placed_without_a_wrong_link) {
  const Case& c = GetParam();
  const fs::path data = shared_folder() / "data" / c.set, tool = shared_folder() / "tools" / "surveyeval.py";
  if (!fs::exists(data) || !fs::exists(tool)) GTEST_SKIP() << "no real scans at " << data << "; set ISTHMUS_SHARED";
  const Said scrambled = run_program(
      "/usr/bin/python3", {tool.string(), "scramble", data.string(), scans_.string(), "1", c.mode}, folder_.path());
  ASSERT_EQ(scrambled.exit_code, 0) << scrambled.err;
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, c.connected ? 0 : 3) << said.err;

  const Said judged =
      run_program("/usr/bin/python3", {tool.string(), "graph", scans_.string(), out_.string()}, folder_.path());
  ASSERT_EQ(judged.exit_code, 0) << judged.err;
  const nlohmann::json result = nlohmann::json::parse(judged.out.substr(0, judged.out.find('\n')));
  EXPECT_EQ(result["wrong"], 0) << judged.out;
  ASSERT_FALSE(result["poses"].is_null()) << judged.out;
  EXPECT_GE(result["poses"]["within"].get<int>(), c.least_within) << judged.out;
}

INSTANTIATE_TEST_SUITE_P(Sets, SharedSurvey,
                         ::testing::Values(Case{"tls_eth_facade", "yaw", 7, true},
                                           Case{"tls_eth_facade", "full", 7, true},
                                           Case{"newer_college_01", "full", 5, true},
                                           Case{"fragments_redkitchen", "full", 3, true},
                                           Case{"stanford_bunny", "object", 8, true}),
                         [](const auto& test) { return test.param.set + "_" + test.param.mode; });

}  // namespace
}  // namespace isthmus::testing
