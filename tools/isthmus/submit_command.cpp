// isthmus submit and status: a survey by the machines of a cluster.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>

#include "commands.h"
#include "exit_codes.h"
#include "number_checks.h"
#include "pipelines/slurm.h"
#include "settings_flags.h"
#include "store/journal.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

namespace fs = std::filesystem;

struct SubmitRun {
  std::vector<std::string> inputs;
  std::string output;
  std::string engine;
  pipelines::SlurmOptions slurm;
  SettingsFlags flags;

  int run() {
    Terminal terminal;
    const Result<pipelines::Job> job = flags.job(inputs, output);
    if (!job) {
      terminal.error(job.error());
      return kUsage;
    }
    std::error_code error;
    slurm.program = fs::read_symlink("/proc/self/exe", error).string();
    const Result<std::vector<pipelines::SlurmJob>> jobs = pipelines::submit_to_slurm(*job, slurm);
    if (!jobs) {
      terminal.error(jobs.error());
      return kFailure;
    }
    for (const pipelines::SlurmJob& one : *jobs) {
      fmt::print("job {}: {}, {} {}\n", one.id, one.stage, one.tasks, one.tasks == 1 ? "task" : "tasks");
    }
    fmt::print("'isthmus status {}' shows how far they are\n", output);
    return kSuccess;
  }
};

/// What went wrong according to the journals, each scan or pair once.
std::map<std::string, std::string> failures_in(const fs::path& output) {
  std::map<std::string, std::string> failures;
  for (const store::ProcessJournal& journal : store::read_journals(output / "journal")) {
    for (const store::JournalLine& line : journal.lines) {
      if (line.event == "failed") failures[line.digest] = line.item;
      if (line.event == "made") failures.erase(line.digest);
    }
  }
  return failures;
}

int show_status(const fs::path& output) {
  Terminal terminal;
  const Result<std::vector<pipelines::Job>> jobs = pipelines::read_jobs(output / "job.yaml");
  if (!jobs || jobs->size() != 1) {
    terminal.error(jobs ? Error{"there is more than one job", output.string(), ""} : jobs.error());
    return kFailure;
  }
  const Result<pipelines::Outlook> outlook = pipelines::look_ahead(jobs->front());
  if (!outlook) {
    terminal.error(outlook.error());
    return kFailure;
  }
  fmt::print("scans: {} of {} described\n", outlook->scans_found, outlook->num_scans - outlook->scans_failed);
  if (outlook->scans_failed > 0) fmt::print("scans that cannot be used: {}\n", outlook->scans_failed);
  fmt::print("pairs: {} of {}{} registered\n", outlook->pairs_found, outlook->pairs_are_known ? "" : "about ",
             outlook->pairs_found + outlook->pairs_to_make);
  std::map<std::string, int> states;
  for (const std::string& state : pipelines::slurm_states(output)) ++states[state];
  for (const auto& [state, count] : states) fmt::print("slurm: {} {}\n", count, state);
  for (const auto& [digest, failure] : failures_in(output)) fmt::print("failed: {}\n", failure);
  const bool finished = outlook->is_complete && fs::exists(output / "run.json");
  fmt::print("{}\n", finished               ? "finished: " + (output / "report.html").string()
                     : outlook->is_complete ? "everything is computed, the results are not written yet"
                                            : "not finished");
  return finished ? kSuccess : kUnfinished;
}

}  // namespace

void add_submit(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("submit", "Register with the machines of a cluster: job arrays of Slurm");
  auto run = std::make_shared<SubmitRun>();
  command->add_option("SCANS", run->inputs, "A folder of scans, or the scan files, on a shared file system")
      ->required();
  command->add_option("-o,--output", run->output, "Folder for the results, on a shared file system")
      ->required()
      ->type_name("OUT");
  command->add_option("--engine", run->engine, "slurm")->required()->check(CLI::IsMember({"slurm"}));
  command->add_option("--partition", run->slurm.partition, "Partition (default: the cluster's)")->type_name("NAME");
  command->add_option("--cpus", run->slurm.cpus, "Processors, and threads, of a task (default: 1)")
      ->type_name("N")
      ->check(above_zero());
  command->add_option("--tasks", run->slurm.most_tasks, "Most tasks of an array (default: 100)")
      ->type_name("N")
      ->check(above_zero());
  command
      ->add_option("--task-minutes", run->slurm.task_minutes,
                   "Short scans and pairs are packed until a task takes about so long (default: 10)")
      ->type_name("M")
      ->check(above_zero());
  command->add_option("--sbatch", run->slurm.more, "A further argument of sbatch, such as --sbatch=--mem=4G")
      ->type_name("ARG")
      ->allow_extra_args(false);
  run->flags.add_config(*command);
  run->flags.add_overrides(*command);
  run->flags.add_store(*command);
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

void add_status(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status", "How far the runs of an output are, and what failed");
  auto output = std::make_shared<std::string>();
  command->add_option("OUT", *output, "Folder of results")->required();
  command->callback([output, &exit_code] { exit_code = show_status(*output); });
}

}  // namespace isthmus::cli
