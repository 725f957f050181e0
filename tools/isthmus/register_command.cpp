// isthmus register: a directory of scans becomes a pose graph.
#include <CLI/CLI.hpp>
#include <memory>

#include "commands.h"
#include "exit_codes.h"
#include "job_runner.h"
#include "settings_flags.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

struct RegisterRun {
  std::vector<std::string> inputs;
  std::string output;
  std::string control;
  SettingsFlags flags;

  int run() const {
    Terminal terminal;
    Result<pipelines::Job> job = flags.job(inputs, output);
    if (!job) {
      terminal.error(job.error());
      return kUsage;
    }
    job->control = control;
    return run_jobs({*job}, "register", terminal);
  }
};

}  // namespace

void add_register(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("register", "Register all scans of a folder: poses, links and a report");
  auto run = std::make_shared<RegisterRun>();
  command->add_option("SCANS", run->inputs, "A folder of scans, or the scan files")->required();
  command
      ->add_option("-o,--output", run->output,
                   "Folder for the results: poses.txt, pose_graph.g2o, report.html and tables. The same command on the "
                   "same folder goes on where it stopped")
      ->required()
      ->type_name("OUT");
  command
      ->add_option(
          "--control", run->control,
          "Known points, stations, poses and level scans (YAML or CSV, docs/stages/control.md): the result stands in "
          "their frame")
      ->type_name("FILE");
  run->flags.add_config(*command);
  run->flags.add_overrides(*command);
  run->flags.add_store(*command);
  run->flags.add_shard(*command);
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
