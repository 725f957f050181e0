#include "pipelines/run_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <mutex>

#include "base/atomic_file.h"
#include "io/scan_directory.h"
#include "pipelines/survey_pipeline.h"
#include "pipelines/survey_record.h"
#include "report/write_outputs.h"
#include "store/store.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec);
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : "unknown";
}

std::uint64_t peak_memory_bytes() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

JobEnd end_of(const report::SurveyRecord& record) {
  for (const report::ScanRecord& scan : record.scans) {
    if (report::component_of(record, scan.id) != 0) return JobEnd::unconnected;
  }
  return JobEnd::connected;
}

/// Where no scans are looked for; the output stays when it is the input, too.
std::vector<fs::path> folders_of_output(const Job& job) {
  std::vector<fs::path> folders = {store_folder(job)};
  std::error_code error;
  const bool is_input =
      std::ranges::any_of(job.inputs, [&](const fs::path& input) { return fs::equivalent(input, job.output, error); });
  if (!is_input) folders.push_back(job.output);
  return folders;
}

std::string text_of(const std::vector<fs::path>& paths) {
  std::vector<std::string> words;
  for (const fs::path& path : paths) words.push_back(path.string());
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace

Result<JobResult> run_job(const Job& job, const std::string& command, const Events& events,
                          const std::atomic<bool>& stop) {
  const auto start = std::chrono::steady_clock::now();
  report::RunRecord run;
  run.command = command;
  run.started = utc_now();
  run.host = host_name();

  Result<io::ScanListing> listing = io::list_scans(job.inputs, folders_of_output(job));
  if (!listing) return tl::unexpected(listing.error());
  for (const std::string& note : listing->notes) events.info(note);
  if (listing->scans.empty()) {
    return fail("no scans found", text_of(job.inputs), "docs/formats.md lists the formats and their extensions");
  }

  const Result<store::Store> store =
      store::Store::open(store_folder(job), [&](const Error& damage) { events.warn(damage.text()); });
  if (!store) return tl::unexpected(store.error());

  JobResult result;
  SurveyOutcome outcome = run_survey(listing->scans, job.settings, *store, events, stop);
  result.num_made = outcome.num_made;
  result.num_found = outcome.num_found;
  if (outcome.stopped) return result;
  run.more = {{"products_made", std::to_string(outcome.num_made)},
              {"products_found", std::to_string(outcome.num_found)},
              {"peak_bytes_in_flight", std::to_string(outcome.peak_bytes_in_flight)}};

  result.record = record_of(job, std::move(outcome));
  result.end = end_of(result.record);
  run.input = text_of(job.inputs);
  run.output = job.output.string();
  run.store = store_folder(job).string();
  run.threads = threads_of(job.settings.run);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.peak_memory_bytes = peak_memory_bytes();
  run.exit_code = result.end == JobEnd::connected ? 0 : 3;
  result.record.run = run;
  std::error_code code;
  fs::create_directories(job.output, code);
  if (code) return fail("cannot create the folder: " + code.message(), job.output.string());
  const Result<void> resolved = write_file_atomically(job.output / "resolved.yaml", resolved_job(job, job.output));
  if (!resolved) return tl::unexpected(resolved.error());
  if (const Result<void> written = report::write_outputs(result.record, job.output); !written) {
    return tl::unexpected(written.error());
  }
  return result;
}

}  // namespace isthmus::pipelines
