// What a run began and finished, line by line, for those who come after it: a resumed run's reader, a person, a test.
//
// OUT/journal/<time>-<host>-<process>.tsv, a file for each process, so that any number of machines may write:
//   <seconds since 1970>  <event>  <stage>  <digest of the product's key>  <item>  <seconds it took>
// separated by tabs. Events: run (item: the command); began, made, failed (item: with the reason) for work; progress
// (item: done/total, of a stage as in Events); found (once for each product), needed (not loaded, but a later run may
// want it) and kept for what the store gave and took; stopped (item: what was done), ended (item: the exit code or what
// went wrong). Each line is one write(2): after kill -9 at most the last is missing.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace isthmus::store {

struct JournalLine {
  double time = 0;  ///< seconds since 1970, UTC
  std::string event;
  std::string stage;
  std::string digest;
  std::string item;
  double seconds = 0;
};

/// Appends to one file. A line that cannot be written (a full disk) is lost silently: the journal informs, nothing is
/// decided by it.
class Journal {
 public:
  /// Creates `folder` and in it the file of this process.
  static Result<std::shared_ptr<Journal>> open(const std::filesystem::path& folder);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Any thread. `time` is filled in.
  void write(JournalLine line);
  /// write(), unless a line with the same event, stage and digest went this way before.
  void write_once(JournalLine line);

 private:
  explicit Journal(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
  std::mutex mutex_;
  std::set<std::string> written_once_;
};

/// What one process wrote; lines that are cut or make no sense are left out.
struct ProcessJournal {
  std::filesystem::path file;
  std::vector<JournalLine> lines;
  /// How often `event` stands there.
  [[nodiscard]] std::size_t count(const std::string& event) const;
};

/// All journals of a folder, oldest first; none if there is no such folder.
std::vector<ProcessJournal> read_journals(const std::filesystem::path& folder);

}  // namespace isthmus::store
