#include "pipelines/job.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/temporary_folder.h"

namespace isthmus::pipelines {
namespace {

class JobFile : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "job.yaml";

  Result<std::vector<Job>> read(const std::string& text) {
    std::ofstream(file_) << text;
    return read_jobs(file_);
  }
  /// The error without the folder in front.
  std::string error_of(const std::string& text) {
    const auto jobs = read(text);
    return jobs ? "no error" : jobs.error().text().substr(folder_.path().string().size() + 1);
  }
};

TEST_F(JobFile, paths_are_relative_to_the_file) {
  const auto jobs = read(
      "input: scans\noutput: ../out\nsettings:\n  sampling: {voxel_m: 0.2, stations: tripods.csv}\n  run: {store: "
      "kept}\n"
      "  candidates: {positions: sketch.csv}\n");
  ASSERT_TRUE(jobs) << jobs.error().text();
  ASSERT_EQ(jobs->size(), 1U);
  const Job& job = jobs->front();
  EXPECT_EQ(job.inputs, std::vector{folder_ / "scans"});
  EXPECT_EQ(job.output, folder_.path().parent_path() / "out");
  EXPECT_EQ(job.settings.sampling.voxel_m, 0.2);
  EXPECT_EQ(job.settings.origins.at("sampling.voxel_m"), file_.string() + ":4");
  EXPECT_EQ(store_folder(job), folder_ / "kept");
  EXPECT_EQ(job.settings.candidates.positions, (folder_ / "sketch.csv").string());
  EXPECT_EQ(job.settings.sampling.stations, (folder_ / "tripods.csv").string());
}

TEST_F(JobFile, a_list_is_a_batch) {
  const auto jobs = read("- {input: [a.ply, b.ply], output: one, profile: quick}\n- {input: /abs, output: two}\n");
  ASSERT_TRUE(jobs) << jobs.error().text();
  ASSERT_EQ(jobs->size(), 2U);
  EXPECT_EQ((*jobs)[0].inputs, (std::vector{folder_ / "a.ply", folder_ / "b.ply"}));
  EXPECT_FALSE((*jobs)[0].settings.origins.empty());
  EXPECT_EQ((*jobs)[1].inputs, std::vector<std::filesystem::path>{"/abs"});
  EXPECT_EQ(store_folder((*jobs)[1]), folder_ / "two" / "store");
}

TEST_F(JobFile, errors_name_file_line_and_column) {
  EXPECT_EQ(error_of("input: a\noutputs: b\n"), "job.yaml:2:1: unknown key 'outputs' (did you mean output?)");
  EXPECT_EQ(error_of("input: a\n"), "job.yaml:1:1: the job has no 'output' (a job needs input and output)");
  EXPECT_EQ(error_of("- {input: a, output: b}\n- {output: b}\n"),
            "job.yaml:2:3: the job has no 'input' (a job needs input and output)");
  EXPECT_EQ(error_of("input: a\noutput: b\nsettings:\n  piar: {}\n"),
            "job.yaml:4:3: unknown key 'piar' (did you mean pair?)");
  EXPECT_EQ(error_of("input: a\noutput: b\nprofile: quik\n"),
            "job.yaml:3:10: there is no such configuration file or profile (did you mean quick?)");
  EXPECT_EQ(error_of("input: []\noutput: b\n"), "job.yaml:1:8: 'input' is empty");
  EXPECT_EQ(error_of("[]"), "job.yaml: the list of jobs is empty");
  EXPECT_FALSE(read_jobs(folder_ / "missing.yaml"));
}

TEST_F(JobFile, two_jobs_with_one_output_are_refused_whatever_the_spelling) {
  std::filesystem::create_directory(folder_ / "b");
  std::filesystem::create_directory_symlink(folder_ / "b", folder_ / "link");
  const std::vector<std::string> spellings = {"b", "./b", "b/", "x/../b", "link", (folder_ / "b").string()};
  for (const std::string& same : spellings) {
    EXPECT_EQ(error_of("- {input: a, output: z}\n- {input: a, output: b}\n- {input: c, output: " + same + "}\n"),
              "job.yaml:3:22: job 3 and job 2 (at " + file_.string() + ":2) write to the same folder " +
                  (folder_ / same).lexically_normal().string() + " (give each job an output of its own)");
  }
  EXPECT_TRUE(read("- {input: a, output: b}\n- {input: a, output: b/inner}\n"));
}

TEST_F(JobFile, a_resolved_job_is_the_same_job) {
  const auto jobs =
      read("input: scans\noutput: out\nsettings:\n  sampling: {voxel_m: 0.30000000000000004}\n  run: {threads: 3}\n");
  ASSERT_TRUE(jobs) << jobs.error().text();
  std::filesystem::create_directories(folder_ / "out");
  const std::string text = resolved_job(jobs->front(), folder_ / "out");
  EXPECT_NE(text.find("input: \"../scans\"\noutput: \".\"\n"), std::string::npos) << text;
  EXPECT_NE(text.find("voxel_m: 0.30000000000000004  # " + file_.string() + ":4\n"), std::string::npos) << text;
  std::ofstream(folder_ / "out" / "resolved.yaml") << text;
  const auto again = read_jobs(folder_ / "out" / "resolved.yaml");
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(std::filesystem::weakly_canonical(again->front().inputs.at(0)),
            std::filesystem::weakly_canonical(folder_ / "scans"));
  EXPECT_EQ(std::filesystem::weakly_canonical(again->front().output),
            std::filesystem::weakly_canonical(folder_ / "out"));
  EXPECT_EQ(again->front().settings.sampling.voxel_m, 0.30000000000000004);
  EXPECT_EQ(again->front().settings.run.threads, 3);
}

}  // namespace
}  // namespace isthmus::pipelines
