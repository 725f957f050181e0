// isthmus config: the default settings, a check of a file, what a key does.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/atomic_file.h"
#include "commands.h"
#include "config/describe.h"
#include "exit_codes.h"
#include "pipelines/job.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

/// A configuration file, or else a job file: told apart by the key 'input'.
Result<void> check_file(const std::string& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const bool is_job = text->starts_with("input:") || text->find("\ninput:") != std::string::npos ||
                      text->starts_with("- ") || text->find("\n- ") != std::string::npos;
  if (is_job) {
    const Result<std::vector<pipelines::Job>> jobs = pipelines::read_jobs(file);
    return jobs ? Result<void>{} : tl::unexpected(jobs.error());
  }
  pipelines::Settings settings;
  return pipelines::apply_config(settings, file);
}

int explain(const std::string& key) {
  pipelines::Settings settings;
  std::vector<config::Stage> stages = settings.stages();
  for (const config::Stage& stage : stages) {
    if (stage.name != key) continue;
    fmt::print("{}: {}\n", stage.name, stage.help);
    for (const config::Option& option : stage.options) fmt::print("\n{}", config::explanation(option));
    return kSuccess;
  }
  const Result<config::Option*> option = config::find_option(stages, key);
  if (!option) {
    Terminal().error(option.error());
    return kUsage;
  }
  fmt::print("{}", config::explanation(**option));
  return kSuccess;
}

}  // namespace

void add_config(CLI::App& app, int& exit_code) {
  CLI::App* config = app.add_subcommand("config", "Show, check or explain settings");
  config->require_subcommand(1);
  config->add_subcommand("default", "Print every setting with its default, as a configuration file")->callback([] {
    pipelines::Settings settings;
    fmt::print("{}", config::annotated_yaml(settings.stages()));
  });
  config->add_subcommand("tables", "Print the tables of docs/configuration.md")->callback([] {
    pipelines::Settings settings;
    fmt::print("{}", config::markdown_tables(settings.stages()));
  });
  CLI::App* check = config->add_subcommand("check", "Check a configuration or job file; errors name line and column");
  auto file = std::make_shared<std::string>();
  check->add_option("FILE", *file, "The file")->required();
  check->callback([file, &exit_code] {
    const Result<void> good = check_file(*file);
    if (!good) Terminal().error(good.error());
    exit_code = good ? kSuccess : kUsage;
  });
  CLI::App* explain_key = config->add_subcommand("explain", "Say what a setting, or a whole section, does");
  auto key = std::make_shared<std::string>();
  explain_key->add_option("KEY", *key, "For instance sampling.voxel_m, or sampling")->required();
  explain_key->callback([key, &exit_code] { exit_code = explain(*key); });
}

}  // namespace isthmus::cli
