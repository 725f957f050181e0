// isthmus run: one job or a batch from a file.
#include <CLI/CLI.hpp>
#include <memory>

#include "commands.h"
#include "exit_codes.h"
#include "job_runner.h"
#include "settings_flags.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

int run_file(const std::string& file, const SettingsFlags& flags) {
  Terminal terminal;
  Result<std::vector<pipelines::Job>> jobs = pipelines::read_jobs(file);
  if (!jobs) {
    terminal.error(jobs.error());
    return kUsage;
  }
  for (pipelines::Job& job : *jobs) {
    if (const Result<void> good = flags.apply(job); !good) {
      terminal.error(good.error());
      return kUsage;
    }
  }
  return run_jobs(*jobs, "run " + file, terminal);
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("run", "Run a job or a batch of jobs from a file; OUT/resolved.yaml repeats a run");
  auto file = std::make_shared<std::string>();
  auto flags = std::make_shared<SettingsFlags>();
  command->add_option("JOB", *file, "Job file (YAML): input, output, profile, settings; or a list of such jobs")
      ->required();
  flags->add_overrides(*command);
  flags->add_store(*command);
  flags->add_shard(*command);
  command->callback([file, flags, &exit_code] { exit_code = run_file(*file, *flags); });
}

}  // namespace isthmus::cli
