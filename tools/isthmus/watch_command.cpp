// isthmus watch: how far a run is that somebody else began, until it is done.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "commands.h"
#include "exit_codes.h"
#include "number_checks.h"
#include "pipelines/night.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

using pipelines::NightEnd;

double now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

/// That of the run: what it wrote when it ended, 1 if that is no number or it was killed.
int exit_code_of(const std::vector<pipelines::NightProcess>& night) {
  const NightEnd end = pipelines::end_of(night);
  constexpr int kInterrupt = 2;
  if (end == NightEnd::stopped) return kSignalBase + kInterrupt;
  if (end != NightEnd::ended) return kFailure;
  const std::string& words = night.back().last_words;
  int code = kFailure;
  const auto read = std::from_chars(words.data(), words.data() + words.size(), code);
  return read.ec == std::errc() && read.ptr == words.data() + words.size() ? code : kFailure;
}

struct WatchRun {
  std::string out;
  double every_s = 1;
  bool once = false;

  int run() const {
    const bool terminal = ::isatty(STDOUT_FILENO) == 1;
    long lines = 0;
    for (;;) {
      const auto night = pipelines::read_night(out);
      if (night.empty()) {
        Terminal().error({"no run has begun here: it holds no journal", out, "name the output of 'register'"});
        return kFailure;
      }
      const std::string text = pipelines::text_of(night, now());
      // The lines of before are written over on a terminal; a log gets new ones.
      if (terminal && lines > 0) fmt::print("\x1b[{}A\x1b[J", lines);
      lines = std::ranges::count(text, '\n');
      fmt::print("{}", text);
      std::fflush(stdout);
      const bool working = pipelines::end_of(night) == NightEnd::none;
      if (!working) return exit_code_of(night);
      if (once) return kSuccess;
      std::this_thread::sleep_for(std::chrono::duration<double>(terminal ? every_s : std::max(every_s, kLogSeconds)));
    }
  }

 private:
  static constexpr double kLogSeconds = 10;
};

}  // namespace

void add_watch(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("watch", "Show how far a run is, until it is done");
  auto run = std::make_shared<WatchRun>();
  command->add_option("OUT", run->out, "Output folder of the run")->required();
  command->add_option("--every", run->every_s, "Seconds between two looks (default: 1; 10 where it is no terminal)")
      ->type_name("SECONDS")
      ->check(above_zero());
  command->add_flag("--once", run->once, "Look once");
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
