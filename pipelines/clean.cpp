#include "pipelines/clean.h"

#include <algorithm>
#include <system_error>

#include "pipelines/job.h"
#include "pipelines/output_folder.h"
#include "store/journal.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

/// A whole run that came to its end: with the exit code of a finished survey, and not one shard of it.
bool is_finished_run(const store::ProcessJournal& journal) {
  if (journal.lines.empty()) return false;
  const store::JournalLine& last = journal.lines.back();
  return last.event == "ended" && (last.item == "0" || last.item == "3");
}

/// From the last finished run on; all if there is none.
std::vector<store::ProcessJournal> journals_that_count(const fs::path& output) {
  std::vector<store::ProcessJournal> journals = store::read_journals(output / "journal");
  const auto last = std::find_if(journals.rbegin(), journals.rend(), is_finished_run);
  if (last != journals.rend()) journals.erase(journals.begin(), last.base() - 1);
  return journals;
}

void add_needs(const fs::path& output, std::set<std::string>& needed) {
  for (const store::ProcessJournal& journal : journals_that_count(output)) {
    for (const store::JournalLine& line : journal.lines) {
      if (line.event == "kept" || line.event == "found" || line.event == "needed")
        needed.insert(line.stage + "/" + line.digest);
    }
  }
}

void remove_old_journals(const fs::path& output) {
  const std::vector<store::ProcessJournal> kept = journals_that_count(output);
  for (const store::ProcessJournal& journal : store::read_journals(output / "journal")) {
    std::error_code ignored;
    if (!kept.empty() && journal.file < kept.front().file) fs::remove(journal.file, ignored);
  }
}

}  // namespace

Result<Cleaning> clean_output(const fs::path& output, const fs::path& store, const store::CollectLimits& limits,
                              bool dry_run) {
  std::error_code error;
  if (!fs::is_directory(output, error)) return fail("there is no such output folder", output.string());
  const Result<OutputFolder> held = OutputFolder::open(output);
  if (!held) return tl::unexpected(held.error());
  Cleaning cleaning;
  cleaning.store = store;
  if (store.empty()) {
    const Result<std::vector<Job>> jobs = read_jobs(output / "job.yaml");
    cleaning.store = jobs && jobs->size() == 1 ? store_folder(jobs->front()) : output / "store";
  }
  if (!fs::is_directory(cleaning.store, error)) return fail("there is no store", cleaning.store.string());
  std::set<fs::path> outputs = store::users_of(cleaning.store);
  outputs.insert(fs::absolute(output).lexically_normal());
  std::set<std::string> needed;
  for (const fs::path& one : outputs) add_needs(one, needed);
  cleaning.outputs.assign(outputs.begin(), outputs.end());
  const Result<store::Collected> collected = store::collect(cleaning.store, needed, limits, dry_run);
  if (!collected) return tl::unexpected(collected.error());
  cleaning.collected = *collected;
  if (!dry_run) remove_old_journals(output);
  return cleaning;
}

}  // namespace isthmus::pipelines
