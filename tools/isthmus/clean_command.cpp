// isthmus clean: gives back the space of products that no run needs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "base/disk_space.h"
#include "commands.h"
#include "exit_codes.h"
#include "number_checks.h"
#include "pipelines/clean.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

constexpr double kBytesPerGigabyte = 1e9;
constexpr double kSecondsPerDay = 86400;

struct CleanRun {
  std::string output;
  std::string store;
  std::optional<double> keep_days;
  std::optional<double> max_gb;
  bool dry_run = false;

  int run() const {
    Terminal terminal;
    store::CollectLimits limits;
    if (keep_days) limits.keep_younger_than = std::chrono::seconds(static_cast<long>(*keep_days * kSecondsPerDay));
    if (max_gb) limits.max_bytes = static_cast<std::uint64_t>(*max_gb * kBytesPerGigabyte);
    const Result<pipelines::Cleaning> cleaning = pipelines::clean_output(output, store, limits, dry_run);
    if (!cleaning) {
      terminal.error(cleaning.error());
      return kFailure;
    }
    const store::Collected& done = cleaning->collected;
    fmt::print("{}: {} {} products ({}); {} stay ({}), {} of them needed by {} {}\n", cleaning->store.string(),
               dry_run ? "would remove" : "removed", done.num_removed, bytes_text(done.bytes_removed),
               done.num_needed + done.num_kept, bytes_text(done.bytes_left), done.num_needed, cleaning->outputs.size(),
               cleaning->outputs.size() == 1 ? "output" : "outputs");
    return kSuccess;
  }
};

}  // namespace

void add_clean(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("clean", "Remove products from the store that no run of its outputs needs");
  auto run = std::make_shared<CleanRun>();
  command->add_option("OUT", run->output, "Folder of results")->required();
  command->add_option("--store", run->store, "Folder of products (default: that of the last run of OUT)")
      ->type_name("DIR");
  command->add_option("--keep-days", run->keep_days, "Keep what is not needed but was made in the last N days")
      ->type_name("N")
      ->check(not_negative());
  command
      ->add_option(
          "--max-size", run->max_gb,
          "Keep of what is not needed the youngest that fit into N GB with the rest; needed products always stay")
      ->type_name("GB")
      ->check(not_negative());
  command->add_flag("--dry-run", run->dry_run, "Say what would be removed and remove nothing");
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
