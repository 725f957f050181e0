#include "job_runner.h"

#include <fmt/format.h>

#include <algorithm>

#include "exit_codes.h"
#include "report/run_json.h"
#include "stop_signal.h"

namespace isthmus::cli {
namespace {

struct Ended {
  int exit_code = kFailure;
  std::string summary;
};

Ended run_one(const pipelines::Job& job, const std::string& command, Terminal& terminal) {
  const pipelines::Events events = terminal.events();
  const Result<pipelines::JobResult> result = pipelines::run_job(job, command, events, stop_requested());
  if (!result) {
    terminal.error(result.error());
    return {kFailure, "failed: " + result.error().text()};
  }
  if (result->num_found > 0) {
    terminal.say(fmt::format("{} products found in the store, {} made", result->num_found, result->num_made));
  }
  switch (result->end) {
    case pipelines::JobEnd::connected:
      return {kSuccess, summary_of(*result, job.output)};
    case pipelines::JobEnd::unconnected:
      return {kUnconnected, summary_of(*result, job.output)};
    case pipelines::JobEnd::shared:
      return {kSuccess, fmt::format("everything is in {}: the same command without --shard collects it",
                                    pipelines::store_folder(job).string())};
    case pipelines::JobEnd::unfinished:
      return {
          kUnfinished,
          fmt::format("shard {} of {} did its share; {} {} of other shards missing: run it again when they are done",
                      job.share.index + 1, job.share.count, result->num_missing,
                      result->num_missing == 1 ? "product is" : "products are")};
    case pipelines::JobEnd::stopped:
      break;
  }
  return {kSignalBase + stop_signal(),
          fmt::format("stopped; what was finished is kept in {}: the same command goes on from there",
                      pipelines::store_folder(job).string())};
}

/// The exit code that tells most: a stop, then a failure, then an unfinished shard, then unconnected scans.
int worse(int a, int b) {
  const auto rank = [](int code) {
    return code >= kSignalBase ? 4 : code == kFailure ? 3 : code == kUnfinished ? 2 : code == kUnconnected ? 1 : 0;
  };
  return rank(a) >= rank(b) ? a : b;
}

}  // namespace

std::string summary_of(const pipelines::JobResult& result, const std::filesystem::path& out) {
  const report::SurveyCounts counts = report::count(result.record);
  std::string text = fmt::format("{} of {} scans in the largest component, {} links accepted of {} pairs tried",
                                 counts.in_largest, counts.scans, counts.accepted, counts.pairs);
  if (counts.components > 1) text += fmt::format(", {} components", counts.components);
  if (counts.failed > 0)
    text += fmt::format(", {} {} not usable", counts.failed, counts.failed == 1 ? "scan" : "scans");
  return text + fmt::format("; report: {}", (out / "report.html").string());
}

int run_jobs(const std::vector<pipelines::Job>& jobs, const std::string& command, Terminal& terminal) {
  catch_stop_signals();
  int exit_code = kSuccess;
  std::vector<std::string> lines;
  for (const pipelines::Job& job : jobs) {
    if (jobs.size() > 1) terminal.say(fmt::format("{}: {}", job.origin, job.output.string()));
    const Ended ended = run_one(job, command, terminal);
    exit_code = worse(exit_code, ended.exit_code);
    lines.push_back(jobs.size() > 1 ? fmt::format("{} ({}): {}", job.origin, job.output.string(), ended.summary)
                                    : ended.summary);
    if (stop_requested()) break;
  }
  for (const std::string& line : lines) fmt::print("{}\n", line);
  return exit_code;
}

}  // namespace isthmus::cli
