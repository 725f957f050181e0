// How far a run is, read from outside: from the journals of its processes and the lock of its folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "store/journal.h"

namespace isthmus::pipelines {

/// "progress" lines of a journal, as Events::progress tells them.
store::JournalLine progress_line(const std::string& stage, std::size_t done, std::size_t total);

struct StageProgress {
  std::string stage;  ///< as in Events::progress
  std::size_t done = 0;
  std::size_t total = 0;
  double per_second = 0;  ///< 0 until two items are done
};

struct WorkInFlight {
  std::string stage;
  std::string item;
  double since = 0;  ///< seconds since 1970
};

enum class NightEnd : std::uint8_t {
  none,     ///< it works
  ended,    ///< it came to its end; `last_words` holds the exit code or what went wrong
  stopped,  ///< it was asked to stop
  killed,   ///< nobody holds the folder, and it said nothing
};

/// One process of the run.
struct NightProcess {
  std::string command;
  double began = 0;
  double last_line = 0;
  std::vector<StageProgress> stages;  ///< in the order in which they began
  std::vector<WorkInFlight> in_flight;
  std::size_t num_failed = 0;
  std::string last_failure;
  NightEnd end = NightEnd::none;
  std::string last_words;
};

/// The processes of the run that began last, and those that worked beside it. `held`: whether a process holds the
/// folder.
std::vector<NightProcess> night_of(const std::vector<store::ProcessJournal>& journals, bool held);

/// Reads OUT/journal and tries OUT/.lock; takes nothing and changes nothing.
std::vector<NightProcess> read_night(const std::filesystem::path& out);

/// What a person wants to know, a few lines; `now` in seconds since 1970.
std::string text_of(const std::vector<NightProcess>& night, double now);

/// "45 s", "3:20", "1:03:20".
std::string clock_text(long long whole_seconds);

/// Of the whole: none while one works, else the worst.
NightEnd end_of(const std::vector<NightProcess>& night);

}  // namespace isthmus::pipelines
