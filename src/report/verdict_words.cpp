#include "report/verdict_words.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/html_text.h"

namespace isthmus::report {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  const std::size_t shown = std::min<std::size_t>(names.size(), 6);
  for (std::size_t k = 0; k < shown; ++k) out += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return names.size() > shown ? out + fmt::format(" and {} more", names.size() - shown) : out;
}

/// What is not in the main part, in words.
std::string missing_sentence(const SurveyRecord& record, const SurveyCounts& c) {
  std::vector<std::string> parts;
  if (c.components > 1)
    parts.push_back(fmt::format("{} in {} of their own", counted(c.placed - c.in_largest, "scan"),
                                c.components == 2 ? "a part" : "parts"));
  if (c.unplaced > 0) parts.push_back(counted(c.unplaced, "scan") + " without any trusted link");
  if (c.failed > 0) parts.push_back(counted(c.failed, "scan") + " that could not be used");
  if (parts.empty() || record.scans.size() < 2) return {};
  return "Not joined: " + list_of(parts) + ". Below is what would join them. ";
}

std::string links_sentence(const SurveyRecord& record, const SurveyCounts& c) {
  if (c.pairs == 0) return {};
  std::string text = fmt::format("Of {} tried, {} {} accepted", counted(c.pairs, "pair"), c.accepted,
                                 c.accepted == 1 ? "was" : "were");
  if (c.accepted > 0)
    text += c.confirmed == c.accepted ? ", every one confirmed by a loop"
                                      : fmt::format("; loops confirm {} of them", c.confirmed);
  text += ". ";
  if (c.overruled > 0)
    text += fmt::format("Loops rejected {} that looked right on {} own. ", counted(c.overruled, "link"),
                        c.overruled == 1 ? "its" : "their");
  if (c.promoted > 0)
    text += fmt::format("Loops settled {} that {} ambiguous alone. ", counted(c.promoted, "link"),
                        c.promoted == 1 ? "was" : "were");
  const std::vector<double> off =
      of_accepted(record, [](const SolvedLink& l) { return l.after ? l.after->translation_m : 0.0; });
  if (off.size() >= 2 && c.confirmed > 0)
    text += fmt::format("Links and solved poses agree to {} (median), at worst {}. ", metres(median_of(off)),
                        metres(*std::max_element(off.begin(), off.end())));
  return text;
}

std::string pair_name(const SurveyRecord& record, const SolvedLink& l) {
  return short_name(find_scan(record, l.link.source)->name, 20) + "–" +
         short_name(find_scan(record, l.link.target)->name, 20);
}

/// Accepted links that nothing else confirms are the ones to check in the field.
std::string bridges_sentence(const SurveyRecord& record) {
  std::vector<std::string> names;
  for (const SolvedLink& l : record.solution.links)
    if (l.link.result.verdict == Verdict::accepted && !l.in_loop && !l.link.guided)
      names.push_back(pair_name(record, l));
  if (names.empty()) return {};
  return fmt::format("No loop checks {}: {}. ", names.size() == 1 ? "one link that a part hangs on" : "these links",
                     list_of(names));
}

/// What a person changed, and what the loops say to that.
std::string edits_sentence(const SurveyRecord& record) {
  std::vector<std::string> out, added, refused;
  for (const SolvedLink& l : record.solution.links) {
    if (l.link.by_hand == ByHand::taken_out) out.push_back(pair_name(record, l));
    if (l.link.by_hand != ByHand::added) continue;
    (l.link.result.verdict == Verdict::accepted ? added : refused).push_back(pair_name(record, l));
  }
  std::string text;
  if (!out.empty()) text += fmt::format("Taken out by hand: {}. ", list_of(out));
  if (!added.empty()) text += fmt::format("Added by hand: {}. ", list_of(added));
  if (!refused.empty()) text += fmt::format("Added by hand, but refused: {}. ", list_of(refused));
  return text;
}

}  // namespace

Headline headline(const SurveyCounts& c) {
  if (c.scans == 0) return {"bad", "No scan was found."};
  if (c.failed == c.scans) return {"bad", "No scan could be read."};
  if (c.in_largest == c.scans)
    return {"good", c.scans == 1 ? "One scan: there is nothing to join."
                                 : fmt::format("All {} scans stand in one survey.", c.scans)};
  if (c.placed == 0) return {"bad", fmt::format("None of the {} scans could be joined to another.", c.scans)};
  return {"partly", fmt::format("{} of {} scans stand in one survey.", c.in_largest, c.scans)};
}

std::string summary_text(const SurveyRecord& record, const SurveyCounts& c) {
  std::string text =
      missing_sentence(record, c) + links_sentence(record, c) + bridges_sentence(record) + edits_sentence(record);
  if (!text.empty()) text.pop_back();  // the space behind the last sentence
  return text;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace isthmus::report
