// isthmus simulate: a survey with exact truth. Its flags are made from the simulator's option table.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <memory>

#include "commands.h"
#include "config/option.h"
#include "exit_codes.h"
#include "simulate/simulate.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

/// "resolution_deg" -> "--resolution", "noise_ppm" stays apart from "noise_m": "--noise-ppm".
std::string flag_of(const config::Option& option) {
  std::string name = option.key;
  for (const std::string_view unit : {"_deg", "_m"}) {
    if (name.ends_with(unit)) name.resize(name.size() - unit.size());
  }
  std::ranges::replace(name, '_', '-');
  return "--" + name;
}

std::string help_of(const config::Option& option) {
  const std::string allowed = option.allowed();
  return fmt::format("{} [{}{}, default {}]", option.help, option.kind(), allowed.empty() ? "" : ", " + allowed,
                     option.default_text);
}

struct SimulateRun {
  SimulateOptions options;
  config::Stage stage = config::bind(simulate_options_table(), options);
  std::vector<std::string> texts = std::vector<std::string>(stage.options.size());

  Result<void> take_flags() {
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (texts[i].empty()) continue;
      if (const Result<void> done = stage.options[i].assign({{texts[i]}, false, false}); !done) return done;
    }
    return {};
  }

  int run() {
    Terminal terminal;
    if (const Result<void> good = take_flags(); !good) {
      terminal.error(good.error());
      return kUsage;
    }
    const pipelines::Events events = terminal.events();
    const auto progress = [&](const SimulatedScan&, std::size_t done, std::size_t total) {
      events.advance("simulating scans", done, total);
    };
    const Result<SimulationSummary> summary = simulate(options, progress);
    if (!summary) {
      terminal.error(summary.error());
      return kFailure;
    }
    std::uint64_t num_points = 0;
    for (const SimulatedScan& scan : summary->scans) num_points += scan.num_points;
    terminal.say(fmt::format("{} scans with {} points in {}", summary->scans.size(), num_points, options.output));
    return kSuccess;
  }
};

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("simulate", "Make a survey that never happened, with exact truth in poses.gt.txt");
  auto run = std::make_shared<SimulateRun>();
  for (std::size_t i = 0; i < run->stage.options.size(); ++i) {
    const config::Option& option = run->stage.options[i];
    if (option.key == "scene") {
      command->add_option("SCENE", run->texts[i], help_of(option))->required();
    } else if (option.key == "output") {
      command->add_option("-o,--output", run->texts[i], "Folder for the scans and poses.gt.txt")
          ->required()
          ->type_name("DIR");
    } else {
      command->add_option(flag_of(option), run->texts[i], help_of(option))->type_name("");
    }
  }
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
