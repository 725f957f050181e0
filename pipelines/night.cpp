#include "pipelines/night.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownInFlight = 4;

/// "42/100"
std::optional<std::pair<std::size_t, std::size_t>> done_and_total(const std::string& item) {
  std::size_t done = 0, total = 0;
  const char* end = item.data() + item.size();
  const auto first = std::from_chars(item.data(), end, done);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '/') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, total);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  return std::pair(done, total);
}

/// Progress of one stage with the times that its rate is made of.
struct StageCount {
  StageProgress progress;
  double first_time = 0;
  std::size_t first_done = 0;
};

void note_progress(std::vector<StageCount>& stages, const store::JournalLine& line) {
  const auto counts = done_and_total(line.item);
  if (!counts) return;
  auto at = std::ranges::find(stages, line.stage, [](const StageCount& s) { return s.progress.stage; });
  if (at == stages.end()) {
    stages.push_back({{line.stage, 0, 0, 0}, line.time, counts->first});
    at = stages.end() - 1;
  }
  at->progress.done = std::max(at->progress.done, counts->first);  // two threads may write in either order
  at->progress.total = std::max(at->progress.total, counts->second);
  const double seconds = line.time - at->first_time;
  const std::size_t since = at->progress.done - std::min(at->progress.done, at->first_done);
  if (seconds > 0 && since > 0) at->progress.per_second = static_cast<double>(since) / seconds;
}

NightProcess process_of(const store::ProcessJournal& journal) {
  NightProcess out;
  std::vector<StageCount> stages;
  std::map<std::string, WorkInFlight> in_flight;  // by stage and digest
  for (const store::JournalLine& line : journal.lines) {
    out.last_line = line.time;
    const std::string key = line.stage + "/" + line.digest;
    if (line.event == "run") {
      out.command = line.item;
      out.began = line.time;
    } else if (line.event == "progress") {
      note_progress(stages, line);
    } else if (line.event == "began") {
      in_flight[key] = {line.stage, line.item, line.time};
    } else if (line.event == "made" || line.event == "failed") {
      in_flight.erase(key);
      if (line.event == "failed") ++out.num_failed, out.last_failure = line.item;
    } else if (line.event == "stopped" || line.event == "ended") {
      out.end = line.event == "ended" ? NightEnd::ended : NightEnd::stopped;
      out.last_words = line.item;
    }
  }
  for (const StageCount& stage : stages) out.stages.push_back(stage.progress);
  for (const auto& [key, work] : in_flight) out.in_flight.push_back(work);
  std::ranges::stable_sort(out.in_flight, {}, &WorkInFlight::since);
  return out;
}

/// Whether somebody holds the lock of the folder. One that cannot be tried is taken for held.
bool is_held(const fs::path& out) {
  const int descriptor = ::open((out / ".lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  const bool shared = !held && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return held || shared;
}

std::string rounded(double seconds) { return clock_text(static_cast<long long>(std::max(0.0, std::round(seconds)))); }

std::string stage_words(const std::string& stage) {
  static const std::map<std::string, std::string> kWords = {{"look", "scans looked at"},
                                                            {"scans", "scans described"},
                                                            {"pairs", "pairs registered"},
                                                            {"others", "waiting for others"}};
  const auto words = kWords.find(stage);
  return words == kWords.end() ? stage : words->second;
}

std::string stage_text(const StageProgress& stage) {
  std::string text = fmt::format("  {:<20} {:>6} of {:<6}", stage_words(stage.stage), stage.done, stage.total);
  if (stage.done >= stage.total || stage.per_second <= 0) return text;
  constexpr double kSecondsPerMinute = 60;
  const double left = static_cast<double>(stage.total - stage.done) / stage.per_second;
  return text + fmt::format(" {:.3g}/min, {} left", kSecondsPerMinute * stage.per_second, rounded(left));
}

std::string in_flight_text(const NightProcess& process, double now) {
  std::string text;
  for (std::size_t k = 0; k < std::min(kShownInFlight, process.in_flight.size()); ++k) {
    const WorkInFlight& work = process.in_flight[k];
    text +=
        fmt::format("{}{} ({}, {})", k == 0 ? "  in work: " : ", ", work.item, work.stage, rounded(now - work.since));
  }
  if (process.in_flight.size() > kShownInFlight)
    text += fmt::format(" and {} more", process.in_flight.size() - kShownInFlight);
  return text;
}

std::string end_text(const NightProcess& process, double now) {
  switch (process.end) {
    case NightEnd::none:
      return fmt::format("last sign of life {} ago", rounded(now - process.last_line));
    case NightEnd::ended:
      return "ended: " + process.last_words;
    case NightEnd::stopped:
      return "stopped; " + process.last_words;
    case NightEnd::killed:
      return "was killed, or its machine was; the same command goes on from there";
  }
  return {};
}

}  // namespace

std::string clock_text(long long whole_seconds) {
  if (whole_seconds < 60) return fmt::format("{} s", whole_seconds);
  if (whole_seconds < 3600) return fmt::format("{}:{:02}", whole_seconds / 60, whole_seconds % 60);
  return fmt::format("{}:{:02}:{:02}", whole_seconds / 3600, whole_seconds / 60 % 60, whole_seconds % 60);
}

store::JournalLine progress_line(const std::string& stage, std::size_t done, std::size_t total) {
  return {0, "progress", stage, "", fmt::format("{}/{}", done, total), 0};
}

std::vector<NightProcess> night_of(const std::vector<store::ProcessJournal>& journals, bool held) {
  std::vector<NightProcess> all;
  for (const store::ProcessJournal& journal : journals) {
    if (!journal.lines.empty()) all.push_back(process_of(journal));
  }
  std::ranges::stable_sort(all, {}, &NightProcess::began);
  if (all.empty()) return all;
  const double newest = all.back().began;
  std::erase_if(all, [&](const NightProcess& process) { return process.last_line < newest; });
  for (NightProcess& process : all) {
    if (process.end == NightEnd::none && !held) process.end = NightEnd::killed;
  }
  return all;
}

std::vector<NightProcess> read_night(const fs::path& out) {
  // The lock first: a run that ends in between has written its last words by the time they are read.
  const bool held = is_held(out);
  return night_of(store::read_journals(out / "journal"), held);
}

NightEnd end_of(const std::vector<NightProcess>& night) {
  NightEnd worst = NightEnd::ended;
  for (const NightProcess& process : night) {
    if (process.end == NightEnd::none) return NightEnd::none;
    worst = std::max(worst, process.end);
  }
  return worst;
}

std::string text_of(const std::vector<NightProcess>& night, double now) {
  std::string text;
  for (const NightProcess& process : night) {
    const double until = process.end == NightEnd::none ? now : process.last_line;
    text += fmt::format("{}, {}, {}\n", process.command, rounded(until - process.began), end_text(process, now));
    for (const StageProgress& stage : process.stages) text += stage_text(stage) + "\n";
    if (process.end != NightEnd::ended && !process.in_flight.empty()) {
      text.append(in_flight_text(process, process.end == NightEnd::none ? now : process.last_line));
      text += "\n";
    }
    if (process.num_failed > 0)
      text += fmt::format("  {} failed, the last: {}\n", process.num_failed, process.last_failure);
  }
  return text;
}

}  // namespace isthmus::pipelines
