#include "pipelines/night.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>

#include "base/temporary_folder.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

class Night : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;

  void write(const std::string& name, const std::string& lines) {
    fs::create_directories(folder_ / "journal");
    std::ofstream(folder_ / "journal" / name) << lines;
  }
  /// Half of a night: 3 of 4 scans in 60 s, the first pair in work.
  const std::string half_ =
      "1000.000\trun\t\t\tregister\t0\n"
      "1000.100\tbegan\tsampled\ta1\ts1.ply\t0\n"
      "1010.000\tmade\tsampled\ta1\ts1.ply\t9.9\n"
      "1010.000\tprogress\tscans\t\t1/4\t0\n"
      "1040.000\tfailed\tsampled\ta2\ts2.ply: the file ends early\t3\n"
      "1040.000\tprogress\tscans\t\t2/4\t0\n"
      "1070.000\tprogress\tscans\t\t3/4\t0\n"
      "1080.000\tbegan\tpair\tb1\ts3.ply with s1.ply\t0\n";
};

TEST_F(Night, TellsHowFarItIsAndWhatIsInWork) {
  write("1.tsv", half_);
  const auto night = night_of(store::read_journals(folder_ / "journal"), true);
  ASSERT_EQ(night.size(), 1U);
  EXPECT_EQ(end_of(night), NightEnd::none);
  ASSERT_EQ(night[0].stages.size(), 1U);
  EXPECT_EQ(night[0].stages[0].done, 3U);
  EXPECT_NEAR(night[0].stages[0].per_second, 2.0 / 60, 1e-12);
  const std::string text = text_of(night, 1100);
  EXPECT_NE(text.find("register, 1:40, last sign of life 20 s ago"), std::string::npos) << text;
  EXPECT_NE(text.find("3 of 4"), std::string::npos) << text;
  EXPECT_NE(text.find("2/min, 30 s left"), std::string::npos) << text;
  EXPECT_NE(text.find("in work: s3.ply with s1.ply (pair, 20 s)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 failed, the last: s2.ply: the file ends early"), std::string::npos) << text;
}

TEST_F(Night, WithoutAHolderItWasKilledUnlessItSaidHowItEnded) {
  write("1.tsv", half_);
  EXPECT_EQ(end_of(read_night(folder_.path())), NightEnd::killed);
  write("1.tsv", half_ + "1200.000\tstopped\t\t\tmade 3, found 0\t0\n");
  EXPECT_EQ(end_of(read_night(folder_.path())), NightEnd::stopped);
  write("1.tsv", half_ + "1200.000\tended\t\t\t3\t0\n");
  const auto night = read_night(folder_.path());
  EXPECT_EQ(end_of(night), NightEnd::ended);
  EXPECT_EQ(text_of(night, 5000).substr(0, 27), "register, 3:20, ended: 3\n  ");
}

TEST_F(Night, TheLockTellsWhetherSomebodyWorks) {
  write("1.tsv", half_);
  for (const int kind : {LOCK_EX, LOCK_SH}) {
    const int descriptor = ::open((folder_ / ".lock").c_str(), O_RDWR | O_CREAT, 0644);
    ASSERT_EQ(::flock(descriptor, kind), 0);
    EXPECT_EQ(end_of(read_night(folder_.path())), NightEnd::none);
    ::close(descriptor);
    EXPECT_EQ(end_of(read_night(folder_.path())), NightEnd::killed);
  }
}

TEST_F(Night, OnlyTheLastRunAndThoseBesideItCount) {
  write("1.tsv", "10\trun\t\t\tregister\t0\n20\tbegan\tpair\tx\told\t0\n");  // killed long ago
  write("2.tsv", "1000\trun\t\t\tshard 1 of 2\t0\n1100\tprogress\tpairs\t\t5/10\t0\n");
  write("3.tsv", "1050\trun\t\t\tshard 2 of 2\t0\n");
  const auto night = night_of(store::read_journals(folder_ / "journal"), true);
  ASSERT_EQ(night.size(), 2U);
  EXPECT_EQ(night[0].command, "shard 1 of 2");
  EXPECT_TRUE(night_of({}, false).empty());
}

TEST_F(Night, ReadsBackWhatItWrites) {
  const store::JournalLine line = progress_line("pairs", 7, 12);
  write("1.tsv", "1\trun\t\t\tregister\t0\n2\t" + line.event + "\t" + line.stage + "\t\t" + line.item +
                     "\t0\n3\tprogress\tpairs\t\tnonsense\t0\n");
  const auto night = night_of(store::read_journals(folder_ / "journal"), true);
  ASSERT_EQ(night.at(0).stages.size(), 1U);
  EXPECT_EQ(night[0].stages[0].done, 7U);
  EXPECT_EQ(night[0].stages[0].total, 12U);
}

}  // namespace
}  // namespace isthmus::pipelines
