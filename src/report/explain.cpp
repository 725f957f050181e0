#include "report/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <numbers>
#include <queue>
#include <vector>

#include "report/html_text.h"

namespace isthmus::report {
namespace {

constexpr std::size_t kMostListed = 8;

using Links = std::vector<const SolvedLink*>;

double deg(double rad) { return rad * 180.0 / std::numbers::pi; }

std::string name_of(const SurveyRecord& record, int id) {
  const ScanRecord* scan = find_scan(record, id);
  return scan != nullptr ? scan->name : std::to_string(id);
}

int other_end(const SolvedLink& l, int id) { return l.link.source == id ? l.link.target : l.link.source; }

Links links_of(const SurveyRecord& record, int id) {
  Links out;
  for (const SolvedLink& l : record.solution.links)
    if (l.link.source == id || l.link.target == id) out.push_back(&l);
  std::stable_sort(out.begin(), out.end(), [](const SolvedLink* a, const SolvedLink* b) {
    const auto rank = [](const SolvedLink* l) { return std::pair(l->link.result.verdict, l->link.result.probability); };
    return rank(a) > rank(b);
  });
  return out;
}

/// Fewest accepted links from a to b without one of them; empty if there is no way.
Links way(const SurveyRecord& record, int a, int b, const SolvedLink* without) {
  std::map<int, Links> at;
  for (const SolvedLink& l : record.solution.links) {
    if (&l == without || l.link.result.verdict != Verdict::accepted) continue;
    at[l.link.source].push_back(&l), at[l.link.target].push_back(&l);
  }
  std::map<int, const SolvedLink*> came_by = {{a, nullptr}};
  std::queue<int> queue({a});
  while (!queue.empty() && !came_by.contains(b)) {
    const int here = queue.front();
    queue.pop();
    for (const SolvedLink* l : at[here])
      if (came_by.try_emplace(other_end(*l, here), l).second) queue.push(other_end(*l, here));
  }
  Links out;
  if (!came_by.contains(b)) return out;
  for (int here = b; here != a; here = other_end(*came_by.at(here), here)) out.push_back(came_by.at(here));
  std::reverse(out.begin(), out.end());
  return out;
}

/// b_from_a along links that start at a.
Transform walked(const Links& links, int a) {
  Transform t = Transform::Identity();
  for (const SolvedLink* l : links) {
    const Transform& step = *l->link.result.target_from_source;
    const bool forward = l->link.source == a;
    t = (forward ? step : step.inverse()) * t;
    a = other_end(*l, a);
  }
  return t;
}

std::string stations_text(const SurveyRecord& record, const Links& links, int a) {
  std::string text = name_of(record, a);
  for (std::size_t k = 0; k < links.size(); ++k) {
    a = other_end(*links[k], a);
    const bool left_out = links.size() > kMostListed && k >= kMostListed / 2 && k + kMostListed / 2 < links.size();
    if (!left_out) text += " - " + name_of(record, a);
    if (left_out && k == kMostListed / 2) text += fmt::format(" - ({} more)", links.size() - kMostListed);
  }
  return text;
}

std::string miss_text(const Transform& a, const Transform& b, const Eigen::Vector3d& p) {
  return fmt::format("{:.2f} deg and {}", deg(rotation_angle_rad(a.linear().transpose() * b.linear())),
                     metres(displacement_m(a, b, p)));
}

/// What the shortest loop through a link says.
std::string loop_line(const SurveyRecord& record, const SolvedLink& l) {
  if (!l.link.result.target_from_source) return {};
  const Links around = way(record, l.link.source, l.link.target, &l);
  if (around.empty()) return "no loop of accepted links passes here: nothing else can confirm or refute it";
  return fmt::format("the loop {} misses by {}", stations_text(record, around, l.link.source),
                     miss_text(*l.link.result.target_from_source, walked(around, l.link.source),
                               find_scan(record, l.link.source)->centre));
}

std::string by_hand_text(const SolvedLink& l) {
  return l.link.by_hand == ByHand::nothing ? "" : fmt::format(", {} by hand", word(l.link.by_hand));
}

std::string link_lines(const SurveyRecord& record, const SolvedLink& l, int id) {
  const PairResult& r = l.link.result;
  std::string text = fmt::format("  {} {}{}: probability {:.2f}", word(r.verdict), name_of(record, other_end(l, id)),
                                 by_hand_text(l), r.probability);
  if (r.verdict == Verdict::accepted) text += fmt::format(", {:.3f} with the loops", l.probability);
  if (r.target_from_source && l.link.by_hand != ByHand::added)
    text += fmt::format(", overlap {}, residual {}", percent(r.overlap), metres(r.rms_m));
  if (l.after)
    text += fmt::format(", off the solved poses by {} and {:.2f} deg", metres(l.after->translation_m),
                        deg(l.after->rotation_rad));
  text += fmt::format("\n    {}\n", r.reason);
  if (r.verdict == Verdict::accepted) {
    if (const std::string loop = loop_line(record, l); !loop.empty()) text += fmt::format("    {}\n", loop);
  }
  return text;
}

std::string list_of(const SurveyRecord& record, const Links& links, int id, Verdict verdict, const char* heading) {
  std::string text;
  std::size_t count = 0;
  for (const SolvedLink* l : links) {
    if (l->link.result.verdict != verdict) continue;
    if (++count <= kMostListed) text += link_lines(record, *l, id);
  }
  if (count == 0) return {};
  if (count > kMostListed) text += fmt::format("  and {} more, see links.csv\n", count - kMostListed);
  return fmt::format("{} ({}):\n", heading, count) + text;
}

std::string part_text(const SurveyRecord& record, int component) {
  const std::size_t size = record.solution.components[static_cast<std::size_t>(component)].scans.size();
  return component == 0 ? fmt::format("the largest part, {} scans", size)
                        : fmt::format("part {}, {} scans", component, size);
}

std::string what_would_join(const SurveyRecord& record, int component) {
  const SolvedLink* best = best_open_link(record, component);
  if (best == nullptr)
    return "No pair with the rest was tried: name one under candidates.groups, or raise candidates.pairs_per_scan.\n";
  const PairResult& r = best->link.result;
  std::string text = fmt::format("What came nearest to joining it to the rest: {} with {}, {}, probability {:.2f}",
                                 name_of(record, best->link.source), name_of(record, best->link.target),
                                 word(r.verdict), r.probability);
  if (r.target_from_source) text += fmt::format(", overlap {}", percent(r.overlap));
  text += fmt::format(": {}.\n", r.reason);
  if (r.verdict == Verdict::ambiguous) {
    text +=
        "A second link that agrees with it would settle it; if you know that it is right, add it with 'isthmus solve "
        "--add-link'.\n";
  } else {
    text +=
        "Another station that sees both sides would join them; if you know how they lie, 'isthmus solve --add-link' "
        "takes a matrix.\n";
  }
  return text;
}

std::string evidence_text(const PairResult& r) {
  std::string text;
  for (const auto& [name, value] : r.evidence)
    text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", name, value);
  return text;
}

std::optional<double> term_of(const PairResult& r, const std::string& name) {
  const auto at = std::find_if(r.evidence.begin(), r.evidence.end(), [&](const auto& t) { return t.first == name; });
  return at == r.evidence.end() ? std::nullopt : std::optional<double>(at->second);
}

std::string rival_text(const PairResult& r) {
  const auto voxels = term_of(r, "rival_voxels"), turned = term_of(r, "rival_deg"), score = term_of(r, "rival_score"),
             best = term_of(r, "score");
  if (!voxels || *voxels <= 0) return {};
  std::string text = fmt::format("Its strongest rival lies {:.0f} voxels away", *voxels);
  if (turned) text += fmt::format(", turned by {:.0f} deg", *turned);
  if (score && best) text += fmt::format(", score {:.3g} against {:.3g}", *score, *best);
  return text + ".\n";
}

/// Triangles with two accepted links over a third scan.
std::string triangles_text(const SurveyRecord& record, const SolvedLink& l) {
  if (!l.link.result.target_from_source) return {};
  std::string text;
  std::size_t count = 0;
  for (const SolvedLink* first : links_of(record, l.link.source)) {
    const int middle = other_end(*first, l.link.source);
    if (first == &l || middle == l.link.target || first->link.result.verdict != Verdict::accepted) continue;
    for (const SolvedLink* second : links_of(record, middle)) {
      if (other_end(*second, middle) != l.link.target || second->link.result.verdict != Verdict::accepted) continue;
      if (++count > kMostListed) continue;
      text += fmt::format("  over {}: {} apart\n", name_of(record, middle),
                          miss_text(*l.link.result.target_from_source, walked({first, second}, l.link.source),
                                    find_scan(record, l.link.source)->centre));
    }
  }
  if (count > kMostListed) text += fmt::format("  and {} more\n", count - kMostListed);
  return count == 0 ? "" : fmt::format("Triangles of accepted links ({}):\n", count) + text;
}

std::string poses_line(const SurveyRecord& record, int a, int b) {
  const auto t = predicted_target_from_source(record.solution, a, b);
  if (!t) return "They are in different parts: the poses say nothing about how they lie to each other.\n";
  const Eigen::Vector3d apart = *t * find_scan(record, a)->centre - find_scan(record, b)->centre;
  return fmt::format("By the solved poses their centres are {} apart.\n", metres(apart.norm()));
}

std::string control_lines(const SurveyRecord& record, int id) {
  std::string text;
  for (const ControlResult& c : record.solution.control) {
    if (c.scan != id) continue;
    text += fmt::format("Control {}: {}", c.name, c.used ? "used" : "not used, " + c.reason);
    if (c.after) text += fmt::format("; off by {}, {} before", metres(c.after->norm()), metres(c.before->norm()));
    text += ".\n";
  }
  return text;
}

}  // namespace

std::string explain_scan(const SurveyRecord& record, int id) {
  const ScanRecord& scan = *find_scan(record, id);
  if (scan.status == ScanStatus::failed)
    return fmt::format("{} could not be used: {}.\nIt takes no part in the survey.\n", scan.name, scan.reason);
  const PlacedScan& placed = *record.solution.find(id);
  const Component& part = record.solution.components[static_cast<std::size_t>(placed.component)];
  const Links links = links_of(record, id);
  std::string text;
  if (scan.status == ScanStatus::placed) {
    text = fmt::format("{} is placed in {}.\n", scan.name, part_text(record, placed.component));
    if (part.anchor == id) {
      text += "It is the anchor: the part stands in its frame.\n";
    } else {
      const Links to_anchor = way(record, id, part.anchor, nullptr);
      text += fmt::format("The shortest way to the anchor: {}.\n", stations_text(record, to_anchor, id));
      if (placed.sigma_m)
        text +=
            fmt::format("Its centre is known to {} against the anchor, its turn to {:.2f} deg (worst directions).\n",
                        metres(*placed.sigma_m), deg(placed.sigma_rad.value_or(0)));
    }
  } else {
    text = fmt::format("{} is not placed: {}.\n", scan.name, scan.reason);
  }
  text += control_lines(record, id);
  text += list_of(record, links, id, Verdict::accepted, "Links that hold it");
  text += list_of(record, links, id, Verdict::ambiguous, "Ambiguous pairs");
  text += list_of(record, links, id, Verdict::rejected, "Rejected pairs");
  text += list_of(record, links, id, Verdict::failed, "Pairs that failed");
  const auto others =
      static_cast<std::size_t>(std::count_if(record.scans.begin(), record.scans.end(),
                                             [](const ScanRecord& s) { return s.status != ScanStatus::failed; })) -
      1;
  if (links.size() < others) text += fmt::format("With {} other scans it was not tried.\n", others - links.size());
  for (const std::string& note : scan.notes) text += fmt::format("Note: {}.\n", note);
  const bool apart = placed.component != 0 || part.scans.size() == 1;
  if (apart && others > 0) text += what_would_join(record, placed.component);
  return text;
}

std::string explain_pair(const SurveyRecord& record, int a, int b) {
  for (const int id : {a, b})
    if (find_scan(record, id)->status == ScanStatus::failed) return explain_scan(record, id);
  std::string text;
  for (const SolvedLink& l : record.solution.links) {
    if (std::minmax(l.link.source, l.link.target) != std::minmax(a, b)) continue;
    const PairResult& r = l.link.result;
    text += fmt::format("{} onto {}: {}{}{}.\n{}.\n", name_of(record, l.link.source), name_of(record, l.link.target),
                        word(r.verdict), by_hand_text(l),
                        l.measured != r.verdict ? fmt::format(" (by itself {})", word(l.measured)) : "", r.reason);
    if (l.link.guided)
      text += "It was found in the second round, by looking where the poses pointed: its agreement proves nothing.\n";
    text += fmt::format("Probability {:.2f} by itself, {:.3f} with the loops.\n", r.probability, l.probability);
    if (r.target_from_source && l.link.by_hand != ByHand::added)
      text += fmt::format("Overlap {} of the one and {} of the other, residual {}.\n", percent(r.overlap_of_source),
                          percent(r.overlap_of_target), metres(r.rms_m));
    if (!r.evidence.empty()) text += fmt::format("Evidence: {}.\n", evidence_text(r));
    text += rival_text(r);
    if (l.after)
      text += fmt::format("Off the solved poses by {} and {:.2f} deg; before optimisation {} and {:.2f} deg.\n",
                          metres(l.after->translation_m), deg(l.after->rotation_rad), metres(l.before->translation_m),
                          deg(l.before->rotation_rad));
    if (std::string loop = loop_line(record, l); !loop.empty()) {
      loop[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(loop[0])));
      text += fmt::format("{}.\n", loop);
    }
    text += triangles_text(record, l);
  }
  if (text.empty()) {
    text = fmt::format(
        "{} with {} was not tried: other pairs of theirs promised more within the budget "
        "(candidates.pairs_per_scan), and the poses did not predict enough overlap.\n"
        "To have it tried, name the two under candidates.groups and register again; all else is found in the store.\n",
        name_of(record, a), name_of(record, b));
    const Links between = way(record, a, b, nullptr);
    if (!between.empty()) text += fmt::format("They hang together over {}.\n", stations_text(record, between, a));
  }
  return text + poses_line(record, a, b);
}

}  // namespace isthmus::report
