#include "terminal.h"

#include <gtest/gtest.h>

namespace isthmus::cli {
namespace {

TEST(DurationText, reads_like_a_clock) {
  EXPECT_EQ(duration_text(0), "0 s");
  EXPECT_EQ(duration_text(8.2), "9 s");
  EXPECT_EQ(duration_text(60), "1:00");
  EXPECT_EQ(duration_text(3909), "1:05:09");
}

TEST(Terminal, writes_plain_lines_where_there_is_no_terminal) {
  testing::internal::CaptureStderr();
  {
    Terminal terminal;
    const pipelines::Events events = terminal.events();
    for (std::size_t i = 1; i <= 1000; ++i) events.advance("pairs", i, 1000);
    events.warn("a scan is empty");
    events.info("done");
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(said.starts_with("registering pairs: 1 of 1000\nregistering pairs: 1000 of 1000")) << said;
  EXPECT_TRUE(said.ends_with("\nwarning: a scan is empty\ndone\n")) << said;
  EXPECT_EQ(said.find('\r'), std::string::npos);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 4) << said;
}

}  // namespace
}  // namespace isthmus::cli
