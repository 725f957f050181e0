#include "pipelines/run_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include "base/atomic_file.h"
#include "io/format_table.h"
#include "io/scan_directory.h"
#include "pipelines/control_file.h"
#include "pipelines/night.h"
#include "pipelines/output_folder.h"
#include "pipelines/planning.h"
#include "pipelines/run_facts.h"
#include "pipelines/scan_positions.h"
#include "pipelines/survey_pipeline.h"
#include "pipelines/survey_record.h"
#include "pipelines/survey_warnings.h"
#include "pipelines/view_clouds.h"
#include "report/write_outputs.h"
#include "store/store.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBetweenLooks{
    500};  // a look loads every summary: seconds would idle, less would load

/// Where no scans are looked for; the output stays when it is the input, too.
std::vector<fs::path> folders_of_output(const Job& job) {
  std::vector<fs::path> folders = {store_folder(job)};
  std::error_code error;
  const bool is_input =
      std::ranges::any_of(job.inputs, [&](const fs::path& input) { return fs::equivalent(input, job.output, error); });
  if (!is_input) folders.push_back(job.output);
  return folders;
}

/// About what the results take on the disk: measured 14 kB and 1.6 kB a pair with 20 scans before the 3D view,
/// temporary twins included; report.json takes 3 kB a pair.
std::uint64_t bytes_of_results(std::size_t num_scans, const CandidateOptions& options) {
  constexpr std::uint64_t kFixed = 150'000, kPerScan = 8'000, kPerPair = 6'000;
  const std::uint64_t all_pairs = static_cast<std::uint64_t>(num_scans) * (num_scans - 1) / 2;
  const std::uint64_t chosen =
      2 * static_cast<std::uint64_t>(num_scans) * static_cast<std::uint64_t>(options.pairs_per_scan);
  const bool all = num_scans <= static_cast<std::size_t>(options.all_pairs_up_to);
  return kFixed + kPerScan * num_scans + kPerPair * (all ? all_pairs : std::min(all_pairs, chosen));
}

/// Takes what the store tells and passes it on.
class StoreTroubles {
 public:
  explicit StoreTroubles(const Events& events) : events_(events) {}
  void add(const Error& error) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(error.text());
    events_.warn(error.text());
  }
  std::vector<std::string> sorted() {
    const std::lock_guard lock(mutex_);
    std::ranges::sort(texts_);
    return texts_;
  }

 private:
  const Events& events_;
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// Files of an earlier run must not pass for this one's if writing ends halfway: run.json is the mark of completeness.
Result<void> write_results(const Job& job, const report::SurveyRecord& record) {
  std::error_code ignored;
  fs::remove(job.output / "run.json", ignored);
  const Result<void> resolved = write_file_atomically(job.output / "resolved.yaml", resolved_job(job, job.output));
  if (!resolved) return resolved;
  return report::write_outputs(record, job.output);
}

std::string extensions() {
  std::vector<std::string_view> all;
  for (const io::Format& format : io::formats()) all.push_back(format.extensions);
  return fmt::format("{}", fmt::join(all, " "));
}

/// Read before the scans are: a wrong file must not show after a long night.
Result<std::vector<ControlItem>> control_items(const Job& job) {
  return job.control.empty() ? std::vector<ControlItem>{} : read_control(job.control);
}

Result<OutputFolder> open_output(const Job& job) {
  return job.share.is_whole() ? OutputFolder::open(job.output) : OutputFolder::open_shared(job.output, plan_word(job));
}

/// A survey as far as this share goes. A shard begins again whenever others may have brought what it lacks.
SurveyOutcome run_share(const std::vector<io::ListedScan>& scans, const Job& job, const store::Store& store,
                        const Events& events, const std::atomic<bool>& stop) {
  SurveyOutcome outcome = run_survey(scans, job.settings, store, events, stop, job.share);
  const Events quiet;
  std::size_t num_made = outcome.num_made;
  auto last_news = std::chrono::steady_clock::now();
  while (outcome.num_missing > 0 && !stop) {
    const std::chrono::duration<double> silence = std::chrono::steady_clock::now() - last_news;
    if (silence.count() >= job.wait_s) break;
    events.advance("others", scans.size() + outcome.pairs.size() - outcome.num_missing,
                   scans.size() + outcome.pairs.size());
    std::this_thread::sleep_for(kBetweenLooks);
    SurveyOutcome next = run_survey(scans, job.settings, store, quiet, stop, job.share);
    const bool news =
        next.num_made > 0 || next.num_missing != outcome.num_missing || next.pairs.size() != outcome.pairs.size();
    if (news) last_news = std::chrono::steady_clock::now();
    num_made += next.num_made;
    outcome = std::move(next);
  }
  outcome.num_made = num_made;
  return outcome;
}

/// A run without a journal is as good as one with it.
std::shared_ptr<store::Journal> open_journal(const Job& job, const std::string& command, const Events& events) {
  Result<std::shared_ptr<store::Journal>> journal = store::Journal::open(job.output / "journal");
  if (!journal) {
    events.warn(journal.error().text());
    return nullptr;
  }
  (*journal)->write({0, "run", "", "", command, 0});
  return std::move(*journal);
}

/// The events, and their progress in the journal for those who watch; what is told twice stands there once.
Events with_journal(const Events& events, const std::shared_ptr<store::Journal>& journal) {
  if (!journal) return events;
  struct Last {
    std::mutex mutex;
    std::string text;
  };
  Events out = events;
  out.progress = [progress = events.progress, journal, last = std::make_shared<Last>()](
                     const std::string& stage, std::size_t done, std::size_t total) {
    if (progress) progress(stage, done, total);
    const store::JournalLine line = progress_line(stage, done, total);
    const std::lock_guard lock(last->mutex);
    if (std::exchange(last->text, line.stage + line.item) != line.stage + line.item) journal->write(line);
  };
  return out;
}

void note(const std::shared_ptr<store::Journal>& journal, const std::string& event, const std::string& text) {
  if (journal) journal->write({0, event, "", "", text, 0});
}

}  // namespace

Result<io::ScanListing> scans_of_job(const Job& job) {
  Result<io::ScanListing> listing = io::list_scans(job.inputs, folders_of_output(job));
  if (!listing || !listing->scans.empty()) return listing;
  return fail("no scans found", text_of_inputs(job), "files are known by their extensions: " + extensions());
}

JobEnd end_of(const report::SurveyRecord& record) {
  for (const report::ScanRecord& scan : record.scans) {
    if (report::component_of(record, scan.id) != 0) return JobEnd::unconnected;
  }
  return JobEnd::connected;
}

std::string text_of_inputs(const Job& job) {
  std::vector<std::string> words;
  for (const fs::path& path : job.inputs) words.push_back(path.string());
  return fmt::format("{}", fmt::join(words, " "));
}

void complete_warnings(report::SurveyRecord& record, const Events& events) {
  const std::vector<std::string> late = survey_warnings(record);
  for (const std::string& warning : late) events.warn(warning);
  for (const std::string& warning : record.solution.warnings) events.warn(warning);
  record.warnings.insert(record.warnings.end(), late.begin(), late.end());
}

Result<JobResult> run_job(const Job& job, const std::string& command, const Events& events,
                          const std::atomic<bool>& stop) {
  const auto start = std::chrono::steady_clock::now();
  report::RunRecord run = begun_run(command);

  Result<OutputFolder> output = open_output(job);  // before anything is read: it may be a long night
  if (!output) return tl::unexpected(output.error());
  Result<io::ScanListing> listing = scans_of_job(job);
  if (!listing) return tl::unexpected(listing.error());
  const Result<std::vector<ControlItem>> control = control_items(job);
  if (!control) return tl::unexpected(control.error());
  std::vector<std::string> names;
  for (const io::ListedScan& scan : listing->scans) names.push_back(scan.scan.name);
  for (const auto& read :
       {read_positions(job.settings.candidates.positions, names), read_stations(job.settings.sampling.stations, names)})
    if (!read) return tl::unexpected(read.error());
  for (const std::string& note : listing->notes) events.info(note);
  bool with_view = false;
  if (job.share.is_whole()) {
    const std::size_t num_scans = listing->scans.size();
    const std::uint64_t bytes = bytes_of_results(num_scans, job.settings.candidates);
    with_view = output->reserve(bytes + bytes_of_view(num_scans)).has_value();
    const Result<void> space = with_view ? Result<void>() : output->reserve(bytes);
    if (!space) return tl::unexpected(space.error());
  }

  StoreTroubles troubles(events);
  Result<store::Store> store =
      store::Store::open(store_folder(job), [&](const Error& trouble) { troubles.add(trouble); });
  if (!store) return tl::unexpected(store.error());
  const std::shared_ptr<store::Journal> journal = open_journal(job, command, events);
  store->set_journal(journal);
  store->add_user(job.output);
  if (const Result<void> written = write_file_atomically(job.output / "job.yaml", resolved_job(job, job.output));
      !written)
    return tl::unexpected(written.error());
  take_readable_twins(*listing, job.settings, *store, stop);
  for (const std::string& warning : listing->warnings) events.warn(warning);

  JobResult result;
  SurveyOutcome outcome = run_share(listing->scans, job, *store, with_journal(events, journal), stop);
  result.num_made = outcome.num_made;
  result.num_found = outcome.num_found;
  if (outcome.stopped) {
    note(journal, "stopped", fmt::format("made {}, found {}", outcome.num_made, outcome.num_found));
    return result;
  }
  if (!job.share.is_whole()) {
    result.end = outcome.num_missing == 0 ? JobEnd::shared : JobEnd::unfinished;
    result.num_missing = outcome.num_missing;
    note(journal, "ended",
         fmt::format("shard {} of {}, {} missing", job.share.index + 1, job.share.count, outcome.num_missing));
    return result;
  }
  run.more = {{"products_made", std::to_string(outcome.num_made)},
              {"products_found", std::to_string(outcome.num_found)},
              {"peak_bytes_in_flight", std::to_string(outcome.peak_bytes_in_flight)}};

  const MeasuredSurvey measured = measured_of(job, outcome, listing->warnings);
  run.more.emplace_back("survey", keep_measured(measured, *store));
  if (!control->empty()) {
    const Result<Control> found = control_of(*control, measured);
    if (!found) return tl::unexpected(found.error());
    outcome.solution = solve(measured.graph, job.settings.solve, *found);
  }
  result.record = record_of(job, measured, std::move(outcome.solution));
  if (with_view)
    add_view_clouds(measured.view_keys, *store, events, result.record);
  else
    go_without_view(kNoSpaceForView, events, result.record);
  complete_warnings(result.record, events);
  result.end = end_of(result.record);
  run.input = text_of_inputs(job);
  run.output = job.output.string();
  run.store = store_folder(job).string();
  run.threads = threads_of(job.settings.run);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.peak_memory_bytes = peak_memory_bytes();
  run.exit_code = result.end == JobEnd::connected ? 0 : 3;
  run.warnings = troubles.sorted();
  result.record.run = run;
  output->give_back();
  if (const Result<void> written = write_results(job, result.record); !written) {
    note(journal, "ended", written.error().text());
    return tl::unexpected(written.error());
  }
  note(journal, "ended", std::to_string(run.exit_code));
  return result;
}

}  // namespace isthmus::pipelines
