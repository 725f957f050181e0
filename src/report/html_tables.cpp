#include "report/html_tables.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "report/html_text.h"
#include "report/loop_closures.h"

namespace isthmus::report {
namespace {

constexpr std::size_t kNameLength = 28;

std::string name_cell(const SurveyRecord& record, int id) {
  const ScanRecord* scan = find_scan(record, id);
  const std::string name = scan != nullptr ? scan->name : "?";
  return fmt::format("<td data-v=\"{}\" title=\"{}\">{}</td>", id, escaped(name),
                     escaped(short_name(name, kNameLength)));
}

/// A right-aligned number that sorts by `value`.
std::string number_cell(double value, const std::string& text) {
  return fmt::format("<td class=\"n\" data-v=\"{:.9g}\">{}</td>", value, escaped(text));
}

std::string empty_cell() { return "<td class=\"n\" data-v=\"\">–</td>"; }

const char* loop_text(const SolvedLink& l) {
  if (l.link.result.verdict != Verdict::accepted) return "";
  return l.in_loop ? "confirmed" : l.link.guided ? "guided" : "none";
}

std::string share_cell(const std::optional<double>& share) {
  return share ? number_cell(*share, percent(*share)) : empty_cell();
}

/// How well the place is fixed in its least certain direction: 0 slides freely.
std::string observability_cell(const std::optional<double>& value) {
  return value ? number_cell(*value, fmt::format("{:.2f}", *value)) : empty_cell();
}

std::string loop_cell(const SurveyRecord& record, const std::optional<LoopClosure>& loop) {
  if (!loop) return empty_cell();
  std::string via;
  for (const int id : loop->via) via += (via.empty() ? "by way of " : ", ") + find_scan(record, id)->name;
  return fmt::format("<td class=\"n\" data-v=\"{:.9g}\" title=\"{}\">{}</td>", loop->translation_m, escaped(via),
                     metres(loop->translation_m));
}

std::string link_row(const SurveyRecord& record, const SolvedLink& l, const LoopClosures& loops) {
  const PairResult& r = l.link.result;
  std::string row = fmt::format("<tr class=\"{0}\" id=\"link-{1}-{2}\" data-link=\"{1}-{2}\" tabindex=\"0\">",
                                word(r.verdict), l.link.source, l.link.target);
  row += name_cell(record, l.link.source) + name_cell(record, l.link.target);
  row += fmt::format("<td data-v=\"{}\"><b class=\"pill {}\">{}</b></td>", 3 - static_cast<int>(r.verdict),
                     word(r.verdict), word(r.verdict));
  row += number_cell(r.probability, fmt::format("{:.3f}", r.probability));
  row += number_cell(l.probability, fmt::format("{:.3f}", l.probability));
  row += r.target_from_source ? number_cell(r.overlap, percent(r.overlap)) + number_cell(r.rms_m, metres(r.rms_m))
                              : empty_cell() + empty_cell();
  row += share_cell(evidence_term(r, "share_under_6mm")) + share_cell(evidence_term(r, "share_under_20mm"));
  row += observability_cell(evidence_term(r, "observability")) + loop_cell(record, loops.of(l.link));
  row += l.after ? number_cell(l.after->translation_m, metres(l.after->translation_m)) +
                       number_cell(l.after->rotation_rad, degrees(l.after->rotation_rad))
                 : empty_cell() + empty_cell();
  row += fmt::format("<td>{}</td><td class=\"why\">{}</td></tr>\n", loop_text(l), escaped(r.reason));
  return row;
}

struct Column {
  const char* name;
  const char* help;
  double unit = 1;  ///< what one stands for when the column is compared with a number in the filter
  bool is_number = true;
};

constexpr Column words(const char* name, const char* help) { return {name, help, 1, false}; }

std::string header(std::initializer_list<Column> columns) {
  std::string out = "<thead><tr>";
  for (const Column& column : columns)
    out += fmt::format("<th{} title=\"{}\" tabindex=\"0\" data-unit=\"{:g}\">{}</th>",
                       column.is_number ? " class=\"n\"" : "", column.help, column.unit, column.name);
  return out + "</tr></thead>";
}

constexpr double kPercent = 0.01, kMillimetre = 0.001, kDegree = std::numbers::pi / 180;

std::string advice(const SurveyRecord& record, const SolvedLink* best) {
  if (best == nullptr) return "No pair with the rest was tried. Name one under <code>candidates.groups</code>.";
  const PairResult& r = best->link.result;
  const std::string source = find_scan(record, best->link.source)->name,
                    target = find_scan(record, best->link.target)->name;
  std::string text = fmt::format("Nearest to joining it: <b>{}</b> with <b>{}</b>, {}, probability {:.2f}",
                                 escaped(source), escaped(target), word(r.verdict), r.probability);
  if (r.target_from_source) text += fmt::format(", overlap {}", percent(r.overlap));
  return text + fmt::format(". {}. Look at it with <code>isthmus pair</code>, or scan once more between the two.",
                            escaped(r.reason));
}

}  // namespace

std::string link_table(const SurveyRecord& record) {
  std::vector<const SolvedLink*> links;
  for (const SolvedLink& l : record.solution.links) links.push_back(&l);
  std::stable_sort(links.begin(), links.end(), [](const SolvedLink* a, const SolvedLink* b) {
    const auto rank = [](const SolvedLink* l) { return std::pair(l->link.result.verdict, l->link.result.probability); };
    return rank(a) > rank(b);
  });
  std::string out = "<table class=\"sortable\" id=\"links\">";
  out += header(
      {words("source", "Later scan of the pair"),
       words("target", "Earlier scan of the pair"),
       words("verdict", "After the loops have spoken"),
       {"alone", "Probability that the link is right, from the pair alone"},
       {"with loops", "The same, given the loops that confirm it"},
       {"overlap", "Share of points with a facing point of the other scan; the smaller direction", kPercent},
       {"residual", "Point to plane over the overlap, root mean square", kMillimetre},
       {"&lt; 6 mm", "Share of the facing points closer to the other scan&#39;s plane than 6 mm", kPercent},
       {"&lt; 2 cm", "The same for 2 cm", kPercent},
       {"balance", "Smallest over largest stiffness against shifts: 0 slides freely, 1 is held on all sides"},
       {"loop error", "How far the shortest loop of other accepted links is from closing with this one", kMillimetre},
       {"off by", "Distance of this link from the solved poses at the source&#39;s centre", kMillimetre},
       {"turned by", "Rotation of this link against the solved poses", kDegree},
       words("loop", "Whether a loop of links confirms it"),
       words("reason", "Why the verdict is what it is")});
  out += "<tbody>";
  const LoopClosures loops(record);
  for (const SolvedLink* l : links) out += link_row(record, *l, loops);
  return out + "</tbody></table>";
}

std::string scan_table(const SurveyRecord& record) {
  std::string out = "<table class=\"sortable\" id=\"scans\">";
  out += header({{"id", "Vertex id in pose_graph.g2o"},
                 words("name", "File"),
                 words("status", "Placed: in a part of two or more scans"),
                 {"part", "Component; 0 is the largest"},
                 {"links", "Accepted links"},
                 {"position ±", "Standard deviation of the position relative to the anchor, worst direction"},
                 {"points read", "In the file"},
                 {"points used", "After voxel sampling"},
                 {"spacing", "Median distance of raw points"},
                 words("station", "How the station's place is known"),
                 words("notes", "")});
  out += "<tbody>";
  for (const ScanRecord& scan : record.scans) {
    const PlacedScan* placed = record.solution.find(scan.id);
    const auto links =
        std::count_if(record.solution.links.begin(), record.solution.links.end(), [&](const SolvedLink& l) {
          return l.link.result.verdict == Verdict::accepted && (l.link.source == scan.id || l.link.target == scan.id);
        });
    std::string notes = scan.reason;
    for (const std::string& note : scan.notes) notes += (notes.empty() ? "" : "; ") + note;
    fmt::format_to(std::back_inserter(out), "<tr class=\"{0}\" id=\"scan-{1}\" data-scan=\"{1}\" tabindex=\"0\">",
                   word(scan.status), scan.id);
    out += number_cell(scan.id, std::to_string(scan.id));
    out += fmt::format("<td title=\"{}\">{}</td>", escaped(scan.name), escaped(scan.name));
    out += fmt::format("<td data-v=\"{}\"><b class=\"pill {}\">{}</b></td>", static_cast<int>(scan.status),
                       word(scan.status), word(scan.status));
    out += placed != nullptr ? number_cell(placed->component, std::to_string(placed->component)) : empty_cell();
    out += number_cell(static_cast<double>(links), std::to_string(links));
    out +=
        placed != nullptr && placed->sigma_m ? number_cell(*placed->sigma_m, metres(*placed->sigma_m)) : empty_cell();
    out += number_cell(static_cast<double>(scan.num_read), large_number(scan.num_read));
    out += number_cell(static_cast<double>(scan.points), large_number(scan.points));
    out += number_cell(scan.spacing_m, metres(scan.spacing_m));
    out += fmt::format("<td>{}</td><td class=\"why\">{}</td></tr>\n", word(scan.station_kind), escaped(notes));
  }
  return out + "</tbody></table>";
}

std::string control_section(const SurveyRecord& record) {
  if (record.solution.control.empty()) return {};
  std::string frames;
  for (std::size_t c = 0; c < record.solution.components.size(); ++c) {
    const auto& world = record.solution.components[c].georeference;
    if (!world) continue;
    const Eigen::Vector3d& shift = world->shift_m;
    frames += world->levelled_only
                  ? fmt::format("<p>Part {} is levelled; its place and heading are its anchor&#39;s.</p>", c)
                  : fmt::format(
                        "<p>Part {} stands in the frame of the control. Datum shift {:.0f} / {:.0f} / {:.0f} m: solved "
                        "coordinates plus the shift are world coordinates; poses.txt holds the sum.</p>",
                        c, shift.x(), shift.y(), shift.z());
  }
  if (frames.empty()) frames = "<p>No part could be placed in the frame of the control.</p>";
  std::string out = frames + "<div class=\"scroll\"><table class=\"sortable\" id=\"control\">";
  out += header({{"name", ""},
                 {"scan", ""},
                 {"used", "Gross errors are not used"},
                 {"off before", "With the survey fitted to the control as a rigid whole"},
                 {"off after", "With links and control solved together"},
                 {"tilt or turn", "After, of level scans and known poses"},
                 {"why not", ""}});
  out += "<tbody>";
  for (const ControlResult& r : record.solution.control) {
    out += fmt::format("<tr><td>{}</td>", escaped(r.name)) + name_cell(record, r.scan);
    out += fmt::format("<td><b class=\"pill {}\">{}</b></td>", r.used ? "accepted" : "rejected", r.used ? "yes" : "no");
    out += r.before ? number_cell(r.before->norm(), metres(r.before->norm())) : empty_cell();
    out += r.after ? number_cell(r.after->norm(), metres(r.after->norm())) : empty_cell();
    out += r.after_rad ? number_cell(*r.after_rad, degrees(*r.after_rad)) : empty_cell();
    out += fmt::format("<td class=\"why\">{}</td></tr>\n", escaped(r.reason));
  }
  return out + "</tbody></table></div>";
}

std::string missing_section(const SurveyRecord& record) {
  std::string items;
  for (const ScanRecord& scan : record.scans)
    if (scan.status == ScanStatus::failed)
      items += fmt::format("<li class=\"failed\"><b class=\"pill failed\">unreadable</b> <b>{}</b><p>{}</p></li>",
                           escaped(scan.name), escaped(scan.reason));
  for (std::size_t c = 1; c < record.solution.components.size(); ++c) {
    const Component& part = record.solution.components[c];
    const SolvedLink* best = best_open_link(record, static_cast<int>(c));
    std::string names;
    for (const int id : part.scans) names += (names.empty() ? "" : ", ") + find_scan(record, id)->name;
    items += fmt::format("<li><b class=\"pill unplaced\">{}</b> <b>{}</b><p>{}</p></li>",
                         part.scans.size() == 1 ? "unplaced" : fmt::format("part {} of {} scans", c, part.scans.size()),
                         escaped(names), advice(record, best));
  }
  return items.empty() ? items : "<ul class=\"missing\">" + items + "</ul>";
}

}  // namespace isthmus::report
