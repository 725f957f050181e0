// isthmus explain: in words, why a scan or a pair is where it is.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "commands.h"
#include "exit_codes.h"
#include "pipelines/solve_again.h"
#include "report/explain.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

struct ExplainRun {
  std::string out, a, b;

  int run() const {
    Terminal terminal;
    const Result<std::string> text = explained(terminal.events());
    if (!text) {
      terminal.error(text.error());
      return kFailure;
    }
    fmt::print("{}", *text);
    return kSuccess;
  }

 private:
  [[nodiscard]] Result<std::string> explained(const pipelines::Events& events) const {
    Result<pipelines::FinishedRun> finished = pipelines::load_finished_run(out, events);
    if (!finished) return tl::unexpected(finished.error());
    const Result<int> first = pipelines::scan_id_of(finished->measured, a);
    if (!first) return tl::unexpected(first.error());
    const Result<int> second = b.empty() ? first : pipelines::scan_id_of(finished->measured, b);
    if (!second) return tl::unexpected(second.error());
    if (!b.empty() && *first == *second) return fail("both names are of one scan", a);
    const Result<report::SurveyRecord> record = pipelines::record_as_solved(std::move(*finished));
    if (!record) return tl::unexpected(record.error());
    return b.empty() ? report::explain_scan(*record, *first) : report::explain_pair(*record, *first, *second);
  }
};

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("explain", "Say in words why a scan, or a pair, of a finished survey is where it is");
  auto run = std::make_shared<ExplainRun>();
  command->add_option("OUT", run->out, "Output folder of 'register' or 'solve'")->required();
  command->add_option("A", run->a, "A scan: its name as in scans.csv, or its file's name")->required();
  command->add_option("B", run->b, "A second scan: the pair is explained");
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
