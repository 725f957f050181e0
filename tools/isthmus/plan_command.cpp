// isthmus plan: what a run would compute, what it would find, why, and what that costs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "base/disk_space.h"
#include "commands.h"
#include "exit_codes.h"
#include "pipelines/outlook.h"
#include "settings_flags.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

constexpr std::size_t kMostNames = 5;  // a line of a terminal; --all shows the rest

struct PlanRun {
  std::vector<std::string> inputs;
  std::string output;
  bool all = false;
  SettingsFlags flags;

  void print_groups(const std::vector<pipelines::OutlookGroup>& groups) const {
    for (const pipelines::OutlookGroup& group : groups) {
      const std::size_t shown = all ? group.items.size() : std::min(group.items.size(), kMostNames);
      const std::vector<std::string> first(group.items.begin(),
                                           group.items.begin() + static_cast<std::ptrdiff_t>(shown));
      const std::string more =
          group.items.size() > shown ? fmt::format(" and {} more", group.items.size() - shown) : std::string();
      fmt::print("  {}: {}{}\n", group.why, fmt::join(first, ", "), more);
    }
  }

  void print(const pipelines::Outlook& outlook, const pipelines::Job& job) const {
    fmt::print("{} scans, voxel {:.6g} m, store {}\n", outlook.num_scans, outlook.voxel_m,
               pipelines::store_folder(job).string());
    fmt::print("scans: {} found, {} to compute\n", outlook.scans_found, outlook.scans_to_make);
    print_groups(outlook.scans);
    if (outlook.scans_failed > 0) fmt::print("scans that cannot be used: {}\n", outlook.scans_failed);
    if (outlook.pairs_are_known) {
      fmt::print("pairs: {} found, {} to compute\n", outlook.pairs_found, outlook.pairs_to_make);
      print_groups(outlook.pairs);
      if (outlook.pairs_are_guessed) {
        fmt::print("  chosen by likeness alone: the glances that a run casts first may choose others\n");
      }
    } else {
      fmt::print("pairs: about {} to compute; which ones is known when the scans are described\n",
                 outlook.pairs_to_make);
    }
    if (outlook.is_complete) {
      fmt::print("nothing to compute: a run would only write its results\n");
      return;
    }
    fmt::print("later rounds: which pairs they try depends on the results of these\n");
    fmt::print("expected: {} with {} threads ({}), at most {} of memory\n", duration_text(outlook.seconds),
               pipelines::threads_of(job.settings.run),
               outlook.timed_items > 0 ? fmt::format("by {} scans and pairs of earlier runs", outlook.timed_items)
                                       : std::string("by general figures, no run was timed here"),
               bytes_text(static_cast<std::uint64_t>(outlook.most_bytes)));
  }

  int run() const {
    Terminal terminal;
    const Result<pipelines::Job> job = flags.job(inputs, output);
    if (!job) {
      terminal.error(job.error());
      return kUsage;
    }
    const Result<pipelines::Outlook> outlook = pipelines::look_ahead(*job);
    if (!outlook) {
      terminal.error(outlook.error());
      return kFailure;
    }
    for (const std::string& warning : outlook->warnings) terminal.warn(warning);
    print(*outlook, *job);
    return kSuccess;
  }
};

}  // namespace

void add_plan(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("plan", "Say what a register with the same words would compute, and why");
  auto run = std::make_shared<PlanRun>();
  command->add_option("SCANS", run->inputs, "A folder of scans, or the scan files")->required();
  command->add_option("-o,--output", run->output, "Folder of the results")->required()->type_name("OUT");
  command->add_flag("--all", run->all, "Name every scan and pair");
  run->flags.add_config(*command);
  run->flags.add_overrides(*command);
  run->flags.add_store(*command);
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
