#include "pipelines/survey_warnings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "io/notes.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kMostNames = 5;  // a line of a terminal; the tables have them all

std::string listed(const std::vector<std::string>& names) {
  const std::span<const std::string> first(names.data(), std::min(names.size(), kMostNames));
  const std::string text = fmt::format("{}", fmt::join(first, ", "));
  return names.size() > kMostNames ? fmt::format("{} and {} more", text, names.size() - kMostNames) : text;
}

/// Words, and whom they are about, in the order of their first appearance.
class Grouped {
 public:
  void add(const std::string& words, const std::string& name) {
    auto group = std::ranges::find(groups_, words, &Group::words);
    if (group == groups_.end()) group = groups_.insert(groups_.end(), {words, {}});
    group->names.push_back(name);
  }
  void append_to(std::vector<std::string>& warnings) const {
    for (const Group& group : groups_) warnings.push_back(listed(group.names) + ": " + group.words);
  }

 private:
  struct Group {
    std::string words;
    std::vector<std::string> names;
  };
  std::vector<Group> groups_;
};

std::string name_of(const report::SurveyRecord& record, int id) { return report::find_scan(record, id)->name; }

void add_parts(const report::SurveyRecord& record, std::vector<std::string>& warnings) {
  const std::vector<Component>& parts = record.solution.components;
  std::vector<std::string> alone;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    std::vector<std::string> names;
    for (const int id : parts[k].scans) names.push_back(name_of(record, id));
    if (names.size() == 1 || parts[0].scans.size() == 1) {
      alone.insert(alone.end(), names.begin(), names.end());
    } else {
      warnings.push_back(fmt::format("{}: a part of {} scans that hangs together, but not with the largest part",
                                     listed(names), names.size()));
    }
  }
  if (parts.size() > 1 && parts[0].scans.size() == 1) alone.insert(alone.begin(), name_of(record, parts[0].scans[0]));
  if (!alone.empty()) warnings.push_back(fmt::format("{}: not joined to any other scan", listed(alone)));
}

}  // namespace

std::vector<std::string> survey_warnings(const report::SurveyRecord& record) {
  std::vector<std::string> warnings;
  Grouped notes, failures;
  for (const report::ScanRecord& scan : record.scans) {
    for (const std::string& note : scan.notes) {
      if (!io::is_matter_of_course(note)) notes.add(note, scan.name);
    }
  }
  for (const SolvedLink& solved : record.solution.links) {
    const Link& link = solved.link;
    if (link.result.verdict != Verdict::failed) continue;
    failures.add("the pair failed: " + link.result.reason,
                 name_of(record, link.source) + " with " + name_of(record, link.target));
  }
  notes.append_to(warnings);
  failures.append_to(warnings);
  add_parts(record, warnings);
  if (record.scans.size() == 1) warnings.push_back(record.scans[0].name + ": the only scan, there is nothing to join");
  return warnings;
}

}  // namespace isthmus::pipelines
