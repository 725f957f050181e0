// isthmus: stitches terrestrial laser scans into a pose graph.
#include <fmt/format.h>
#include <malloc.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "commands.h"
#include "exit_codes.h"
#include "isthmus_version.h"

namespace {

constexpr const char* kAbout =
    "Isthmus stitches terrestrial laser scans: a folder of scans becomes a graph of poses.\n"
    "No targets, no start positions, no known overlap are needed; scans may lie in any order.\n\n"
    "  isthmus register scans/ -o out/     all scans of a folder; then open out/report.html\n"
    "  isthmus pair a.ply b.ply            how does a fit onto b?\n";

constexpr const char* kExitCodes =
    "Exit codes: 0 all scans hang together (pair: accepted), 3 finished, but scans are unconnected or\n"
    "unreadable (pair: not accepted), 4 a shard waits for others, 2 wrong usage or configuration, 1 failure, 130 or\n"
    "143 stopped by Ctrl-C or a signal (the same command goes on from there). Messages go to standard error.";

/// glibc raises its threshold for blocks of their own with every large block that is freed, and from then on keeps what
/// scans and pairs leave behind: a quarter of the peak on 20 scans of 5 million points was such leavings. A fixed
/// threshold costs 3 % of the time.
void give_back_large_blocks() {
  constexpr int kLargeBytes = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargeBytes);
  mallopt(M_TRIM_THRESHOLD, kLargeBytes);
}

}  // namespace

int main(int argc, char** argv) {
  give_back_large_blocks();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the user's limit is an error like a full disk, not the end
  CLI::App app(kAbout, "isthmus");
  app.set_version_flag("--version", fmt::format("isthmus {}", isthmus::kVersion), "Show the version");
  app.set_help_flag("-h,--help", "Show this help; 'isthmus COMMAND --help' shows a command's");
  app.footer(kExitCodes);
  app.require_subcommand(1);
  int exit_code = isthmus::cli::kSuccess;
  isthmus::cli::add_register(app, exit_code);
  isthmus::cli::add_run(app, exit_code);
  isthmus::cli::add_solve(app, exit_code);
  isthmus::cli::add_explain(app, exit_code);
  isthmus::cli::add_pair(app, exit_code);
  isthmus::cli::add_inspect(app, exit_code);
  isthmus::cli::add_simulate(app, exit_code);
  isthmus::cli::add_evaluate(app, exit_code);
  isthmus::cli::add_export(app, exit_code);
  isthmus::cli::add_watch(app, exit_code);
  isthmus::cli::add_config(app, exit_code);
  isthmus::cli::add_clean(app, exit_code);
  isthmus::cli::add_plan(app, exit_code);
  isthmus::cli::add_submit(app, exit_code);
  isthmus::cli::add_status(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_help = app.exit(error) == 0;
    return asked_for_help ? isthmus::cli::kSuccess : isthmus::cli::kUsage;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: not enough memory (give the program more, or fewer --threads, less --memory)\n");
    return isthmus::cli::kFailure;
  } catch (const std::exception& error) {
    fmt::print(stderr, "isthmus: internal failure: {}\n", error.what());
    return isthmus::cli::kFailure;
  }
  // A pipe or a disk that took only half of the results must not look like success.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    fmt::print(stderr, "error: standard output: cannot be written: {}\n", std::strerror(errno));
    return isthmus::cli::kFailure;
  }
  return exit_code;
}
