// A small simulated survey on disk and the program run on it.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/run_program.h"
#include "base/temporary_folder.h"
#include "evaluate/evaluate.h"
#include "simulate/simulate.h"

namespace isthmus::testing {

namespace fs = std::filesystem;

/// The files whose bytes may not depend on threads, order of files or what was in the store.
inline const std::vector<std::string> kDeterministicFiles = {"scans.csv", "poses.txt", "pose_graph.g2o", "links.csv",
                                                             "covariances.csv"};
inline const std::vector<std::string> kAllFiles = {"scans.csv",       "poses.txt",   "pose_graph.g2o", "links.csv",
                                                   "covariances.csv", "timings.csv", "run.json",       "resolved.yaml",
                                                   "report.html",     "report.json"};

class SurveyOnDisk : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path scans_ = folder_ / "scans";
  fs::path out_ = folder_ / "out";

  /// Stations of an office floor, coarse enough to be registered in a few seconds.
  void make_survey(int stations, const std::string& scene = "office") {
    SimulateOptions options;
    options.scene = scene;
    options.output = scans_.string();
    options.stations = stations;
    options.resolution_deg = 0.5;
    const auto made = simulate(options);
    ASSERT_TRUE(made) << made.error().text();
  }

  /// Files changed a moment ago are always read anew, and their digests not kept; these were not.
  void make_old_survey(int stations) {
    make_survey(stations);
    for (const auto& entry : fs::directory_iterator(scans_)) {
      fs::last_write_time(entry.path(), entry.last_write_time() - std::chrono::hours(1));
    }
  }

  Said run(const std::vector<std::string>& arguments) {
    return run_program(ISTHMUS_PROGRAM, arguments, folder_.path());
  }

  Said register_scans(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"register", scans_.string(), "-o", out_.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  static nlohmann::json run_json(const fs::path& out) { return nlohmann::json::parse(text_of_file(out / "run.json")); }

  evaluate::Evaluation evaluate_out(const fs::path& out) {
    evaluate::EvaluateOptions options;
    options.truth = scans_ / "poses.gt.txt";
    const auto evaluation = evaluate::evaluate(out, scans_, options);
    EXPECT_TRUE(evaluation) << evaluation.error().text();
    return evaluation.value_or(evaluate::Evaluation{});
  }

  static void expect_same_bytes(const fs::path& a, const fs::path& b) {
    for (const std::string& file : kDeterministicFiles) {
      EXPECT_EQ(text_of_file(a / file), text_of_file(b / file)) << file << " of " << a << " and " << b;
    }
  }
};

}  // namespace isthmus::testing
