// isthmus solve: a finished survey, solved again with links taken out or added by hand.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <tuple>

#include "commands.h"
#include "exit_codes.h"
#include "job_runner.h"
#include "pipelines/solve_again.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

struct SolveRun {
  std::string out;
  std::vector<std::tuple<std::string, std::string>> without;
  std::vector<std::tuple<std::string, std::string, std::string>> added;
  std::vector<std::string> assignments;
  std::string control;

  int run() const {
    Terminal terminal;
    const pipelines::Events events = terminal.events();
    const Result<pipelines::JobResult> result = pipelines::solve_again(out, edits(), command(), events);
    if (!result) {
      terminal.error(result.error());
      return kFailure;
    }
    fmt::print("{}\n", summary_of(*result, out));
    return result->end == pipelines::JobEnd::connected ? kSuccess : kUnconnected;
  }

 private:
  [[nodiscard]] pipelines::SolveEdits edits() const {
    pipelines::SolveEdits edits;
    for (const auto& [a, b] : without) edits.take_out.push_back({a, b});
    for (const auto& [source, target, matrix] : added) edits.add.push_back({source, target, matrix});
    edits.assignments = assignments;
    edits.control = control;
    return edits;
  }
  [[nodiscard]] std::string command() const {
    std::string text = "solve";
    for (const auto& [a, b] : without) text += fmt::format(" --without-link {} {}", a, b);
    for (const auto& [source, target, matrix] : added)
      text += fmt::format(" --add-link {} {} {}", source, target, matrix);
    if (!control.empty()) text += fmt::format(" --control {}", control);
    for (const std::string& assignment : assignments) text += fmt::format(" --set {}", assignment);
    return text;
  }
};

}  // namespace

void add_solve(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "solve", "Solve a finished survey again, with links taken out or added; nothing is registered");
  auto run = std::make_shared<SolveRun>();
  command->add_option("OUT", run->out, "Output folder of 'register'; its files are written anew")->required();
  command
      ->add_option(
          "--without-link", run->without,
          "Do without the link between two scans; may be given again. Names as in scans.csv, or the files' names")
      ->type_name("A B")
      ->allow_extra_args(false);
  command
      ->add_option("--add-link", run->added,
                   "Add a link: FILE holds the 3x4 or 4x4 matrix, row by row, that maps A's coordinates to B's; may be "
                   "given again")
      ->type_name("A B FILE")
      ->allow_extra_args(false);
  command
      ->add_option(
          "--control", run->control,
          "Known points, stations, poses and level scans (YAML or CSV, docs/stages/control.md): the result stands in "
          "their frame. Default: the file that the run had, if any")
      ->type_name("FILE");
  command->add_option("--set", run->assignments, "Change a setting of the section 'solve'; may be given again")
      ->type_name("solve.KEY=VALUE")
      ->allow_extra_args(false);
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
