// isthmus evaluate: a survey's outputs against ground truth.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "base/atomic_file.h"
#include "commands.h"
#include "evaluate/evaluate.h"
#include "exit_codes.h"
#include "number_checks.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

namespace fs = std::filesystem;

struct EvaluateRun {
  std::string out;
  std::string truth;
  std::string overlaps;
  std::string scans;
  std::string json_file;
  bool json = false;
  double voxel_m = 0;
  double max_deg = 1;
  double max_m = 0;

  int run() const {
    Terminal terminal;
    evaluate::EvaluateOptions options;
    options.truth = truth;
    if (!overlaps.empty()) options.overlaps = overlaps;
    if (voxel_m > 0) options.voxel_m = voxel_m;
    if (max_m > 0) options.max_m = max_m;
    options.max_deg = max_deg;
    // The truth lies beside the scans unless it is said otherwise.
    const fs::path folder = scans.empty() ? fs::absolute(truth).parent_path() : fs::path(scans);
    const Result<evaluate::Evaluation> evaluation = evaluate::evaluate(out, folder, options);
    if (!evaluation) {
      terminal.error(evaluation.error());
      return kFailure;
    }
    if (!json_file.empty()) {
      if (const Result<void> written = write_file_atomically(json_file, evaluate::json_of(*evaluation) + "\n");
          !written) {
        terminal.error(written.error());
        return kFailure;
      }
    }
    fmt::print("{}\n", json ? evaluate::json_of(*evaluation) : evaluate::text_of(*evaluation));
    return kSuccess;
  }
};

}  // namespace

void add_evaluate(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("evaluate", "Compare a survey's results with the truth");
  auto run = std::make_shared<EvaluateRun>();
  command->add_option("OUT", run->out, "Output folder of 'register'")->required();
  command->add_option("--truth", run->truth, "True poses: name and the 3x4 matrix scan -> common frame, row by row")
      ->required()
      ->type_name("FILE");
  command->add_option("--overlaps", run->overlaps, "Overlaps of pairs; computed from the scans if not given")
      ->type_name("FILE");
  command->add_option("--scans", run->scans, "Folder of the scans (default: where the truth lies)")->type_name("DIR");
  command->add_option("--voxel", run->voxel_m, "Evaluation voxel, metres")->type_name("M")->check(above_zero());
  command->add_option("--max-deg", run->max_deg, "A pose is good within this rotation")
      ->type_name("DEG")
      ->check(above_zero());
  command->add_option("--max-m", run->max_m, "and this distance (default: two evaluation voxels)")
      ->type_name("M")
      ->check(above_zero());
  command->add_flag("--json", run->json, "Print JSON instead of text");
  command->add_option("--json-file", run->json_file, "Also write JSON to this file")->type_name("FILE");
  command->callback([run, &exit_code] { exit_code = run->run(); });
}

}  // namespace isthmus::cli
