// The table of docs/faults.md, one test for each of its lines that has none elsewhere.
#include <sys/mount.h>

#include <atomic>

#include "end_to_end/survey_on_disk.h"
#include "pipelines/run_job.h"

namespace isthmus::testing {
namespace {

class Faults : public SurveyOnDisk {
 protected:
  /// Runs in this process, with something that happens when all scans were looked at and none was read yet.
  pipelines::JobResult run_and_meanwhile(const std::function<void()>& happens) {
    pipelines::Job job;
    job.inputs = {scans_};
    job.output = out_;
    const std::atomic<bool> never_stop{false};
    const pipelines::Events events{{}, [&](const std::string& stage, std::size_t done, std::size_t total) {
                                     if (stage == "look" && done == total) happens();
                                   }};
    const auto result = pipelines::run_job(job, "test", events, never_stop);
    EXPECT_TRUE(result) << result.error().text();
    return result.value_or(pipelines::JobResult{});
  }
};

TEST_F(Faults, a_scan_that_vanishes_while_running_costs_its_own_pairs_only) {
  make_survey(3);
  const auto result = run_and_meanwhile([&] { fs::remove(scans_ / "scan_002.ply"); });
  EXPECT_EQ(result.end, pipelines::JobEnd::unconnected);
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("scan_002.ply,failed"), std::string::npos) << table;
  EXPECT_NE(table.find("No such file"), std::string::npos) << table;
  EXPECT_NE(table.find("scan_001.ply,placed"), std::string::npos) << table;
}

TEST_F(Faults, a_scan_that_changes_while_running_is_named_and_leaves_no_wrong_product) {
  make_survey(3);
  fs::copy(scans_ / "scan_002.ply", folder_ / "good.ply");
  ASSERT_EQ(run({"register", scans_.string(), "-o", (folder_ / "whole").string()}).exit_code, 0);
  const fs::file_time_type time = fs::last_write_time(scans_ / "scan_002.ply");
  const auto result = run_and_meanwhile(
      [&] { fs::copy_file(scans_ / "scan_001.ply", scans_ / "scan_002.ply", fs::copy_options::overwrite_existing); });
  EXPECT_EQ(result.end, pipelines::JobEnd::unconnected);
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("scan_002.ply: it changed while the run was working"), std::string::npos) << table;

  fs::copy_file(folder_ / "good.ply", scans_ / "scan_002.ply", fs::copy_options::overwrite_existing);
  fs::last_write_time(scans_ / "scan_002.ply", time);
  ASSERT_EQ(register_scans().exit_code, 0);
  expect_same_bytes(folder_ / "whole", out_);
}

TEST_F(Faults, a_scan_cut_short_is_named_with_what_is_missing) {
  make_survey(3);
  fs::resize_file(scans_ / "scan_001.ply", fs::file_size(scans_ / "scan_001.ply") * 2 / 3);
  const Said said = register_scans();
  EXPECT_EQ(said.exit_code, 3) << said.err;
  EXPECT_NE(said.err.find("scan_001.ply"), std::string::npos) << said.err;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_NE(table.find("scan_001.ply,failed"), std::string::npos) << table;
  EXPECT_NE(table.find("the header says "), std::string::npos) << table;
  EXPECT_NE(table.find(", the file holds "), std::string::npos) << table;
  EXPECT_EQ(table.find("scan_000.ply,failed"), std::string::npos) << table;
  EXPECT_EQ(table.find("scan_002.ply,failed"), std::string::npos) << table;
}

/// `ulimit -v`: from hardly enough to start to nearly enough to finish, the program says so and corrupts nothing.
TEST_F(Faults, too_little_memory_is_said_and_the_next_run_is_not_harmed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limits of this test";
#endif
  make_survey(2);
  ASSERT_EQ(run({"register", scans_.string(), "-o", (folder_ / "whole").string(), "--threads", "1"}).exit_code, 0);
  int short_of_memory = 0;
  for (const int megabytes : {150, 200, 225, 250, 275, 300, 350, 400}) {
    const std::string command = "ulimit -v " + std::to_string(megabytes * 1024) + "; exec " + ISTHMUS_PROGRAM +
                                " register " + scans_.string() + " -o " + out_.string() + " --threads 1";
    const Said said = run_program("/bin/sh", {"-c", command}, folder_.path());
    if (said.exit_code == 127) continue;  // the loader itself could not map the libraries
    EXPECT_TRUE(said.exit_code == 0 || said.exit_code == 1 || said.exit_code == 3)
        << megabytes << " MB: " << said.exit_code << "\n"
        << said.err;
    if (said.exit_code == 0) break;
    short_of_memory += said.err.find("not enough memory") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(short_of_memory, 0) << "no limit was felt";
  const Said said = register_scans({"--threads", "1"});
  ASSERT_EQ(said.exit_code, 0) << said.err;
  EXPECT_EQ(said.err.find("damaged"), std::string::npos) << said.err;
  expect_same_bytes(folder_ / "whole", out_);
}

/// A small file system of its own, where mounting is allowed.
class SmallFileSystem : public Faults {
 protected:
  fs::path disk_ = folder_ / "disk";
  bool mounted_ = false;
  void mount(const std::string& size) {
    fs::create_directories(disk_);
    mounted_ = ::mount("tmpfs", disk_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  void TearDown() override {
    if (mounted_) ::umount2(disk_.c_str(), MNT_DETACH);
  }
};

TEST_F(SmallFileSystem, that_fills_up_with_products_costs_time_only) {
  mount("1500k");
  if (!mounted_) GTEST_SKIP() << "mounting a tmpfs is not allowed here";
  make_survey(2);
  ASSERT_EQ(run({"register", scans_.string(), "-o", (folder_ / "whole").string()}).exit_code, 0);
  const Said said = run({"register", scans_.string(), "-o", (disk_ / "out").string()});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_NE(said.err.find("what was computed cannot be kept: cannot be written: No space left on device"),
            std::string::npos)
      << said.err;
  expect_same_bytes(folder_ / "whole", disk_ / "out");
}

TEST_F(SmallFileSystem, that_cannot_hold_the_results_is_refused_at_once) {
  mount("100k");
  if (!mounted_) GTEST_SKIP() << "mounting a tmpfs is not allowed here";
  make_survey(2);
  const Said said = run({"register", scans_.string(), "-o", (disk_ / "out").string()});
  EXPECT_EQ(said.exit_code, 1) << said.err;
  EXPECT_NE(said.err.find("there is no space for the results: No space left on device"), std::string::npos) << said.err;
  EXPECT_EQ(said.err.find("looking at scans"), std::string::npos) << said.err;
}

TEST_F(SmallFileSystem, that_is_read_only_is_refused_at_once) {
  mount("1m");
  if (!mounted_) GTEST_SKIP() << "mounting a tmpfs is not allowed here";
  fs::create_directories(disk_ / "out");
  ASSERT_EQ(::mount("tmpfs", disk_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, ""), 0);
  make_survey(1);
  const Said said = run({"register", scans_.string(), "-o", (disk_ / "out").string()});
  EXPECT_EQ(said.exit_code, 1) << said.err;
  EXPECT_NE(said.err.find("the output cannot be written: Read-only file system"), std::string::npos) << said.err;
}

}  // namespace
}  // namespace isthmus::testing
