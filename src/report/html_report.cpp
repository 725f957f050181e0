#include "report/html_report.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "report/charts.h"
#include "report/html_tables.h"
#include "report/html_text.h"
#include "report/page_parts.h"
#include "report/plan_map.h"
#include "report/run_json.h"
#include "report/verdict_words.h"
#include "report/view_section.h"

namespace isthmus::report {
namespace {

std::string tile(const std::string& value, const std::string& label) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>", value, label);
}

std::string tiles(const SurveyRecord& record, const SurveyCounts& c) {
  std::string out = "<div class=\"tiles\">";
  out += tile(fmt::format("{} / {}", c.placed, c.scans), "scans placed");
  out += tile(fmt::format("{} / {}", c.accepted, c.pairs), "links accepted of pairs tried");
  out += tile(fmt::format("{} / {}", c.confirmed, c.accepted), "links confirmed by a loop");
  if (c.accepted > 0) {
    out += tile(percent(median_of(of_accepted(record, [](const SolvedLink& l) { return l.link.result.overlap; }))),
                "median overlap");
    out += tile(metres(median_of(of_accepted(record, [](const SolvedLink& l) { return l.link.result.rms_m; }))),
                "median residual");
  }
  out += tile(metres(record.voxel_m), "voxel");
  if (record.run.seconds > 0) out += tile(duration(record.run.seconds), "running time");
  return out + "</div>";
}

std::string maps(const SurveyRecord& record) {
  std::string small, out;
  for (std::size_t k = 0; k < record.solution.components.size(); ++k) {
    const std::size_t size = record.solution.components[k].scans.size();
    if (size < 2) break;
    const std::string svg = plan_map_svg(record, static_cast<int>(k), k == 0);
    if (k == 0)
      out = "<div class=\"card\">" + svg + plan_map_legend() + "</div>";
    else
      small +=
          fmt::format("<div class=\"card\"><h3>Part {}: {} scans, in a frame of its own</h3>{}</div>", k, size, svg);
  }
  if (out.empty()) return {};
  if (!small.empty()) out += "<div class=\"parts\">" + small + "</div>";
  return "<h2>Plan</h2>" + out;
}

std::string pairs_section(const SurveyRecord& record) {
  const std::string matrix = pair_matrix(record);
  if (matrix.empty()) return {};
  return "<h2>Pairs</h2><div class=\"two\"><div class=\"card\">" + matrix +
         "<div class=\"legend\"><span class=\"keys\">below the diagonal: <i class=\"swatch square c0\"></i>accepted, "
         "by probability "
         "<i class=\"swatch square ambiguous\"></i>ambiguous <i class=\"swatch square rejected\"></i>rejected "
         "<i class=\"swatch square failed\"></i>failed</span><span class=\"keys\">above: <i class=\"swatch square "
         "overlap\"></i>overlap"
         "</span></div></div><div class=\"card\">" +
         overlap_histogram(record) + residual_histogram(record) + loop_histogram(record) + "</div></div>";
}

std::string links_section(const SurveyRecord& record, const SurveyCounts& c) {
  if (c.pairs == 0) return {};
  std::string out = "<h2>Links</h2><div class=\"filters\"><button data-verdict=\"all\" aria-pressed=\"true\">all " +
                    std::to_string(c.pairs) + "</button>";
  for (const auto& [verdict, n] :
       {std::pair(Verdict::accepted, c.accepted), std::pair(Verdict::ambiguous, c.ambiguous),
        std::pair(Verdict::rejected, c.rejected), std::pair(Verdict::failed, c.pairs_failed)})
    if (n > 0)
      out += fmt::format("<button data-verdict=\"{0}\" aria-pressed=\"false\">{0} {1}</button>", word(verdict), n);
  return out +
         "<span id=\"shown\" class=\"quiet count\"></span><input id=\"needle\" type=\"search\" placeholder=\"Scan, "
         "reason, or overlap&lt;20 residual&gt;5\" "
         "aria-label=\"Filter links by words and bounds\"></div><div "
         "class=\"scroll\">" +
         link_table(record) + "</div>";
}

std::string warnings_section(const SurveyRecord& record) {
  std::string items;
  for (const auto* list : {&record.warnings, &record.solution.warnings, &record.run.warnings})
    for (const std::string& warning : *list) items += "<li>" + escaped(warning) + "</li>";
  return items.empty() ? items : "<h2>Warnings</h2><ul class=\"warnings\">" + items + "</ul>";
}

std::string fact(std::string_view name, const std::string& value) {
  return value.empty() ? value : fmt::format("<tr><th>{}</th><td>{}</td></tr>", escaped(name), escaped(value));
}

std::string run_section(const SurveyRecord& record) {
  const RunRecord& run = record.run;
  std::string facts;
  for (const auto& [name, version] : record.versions) facts += fact(name, version);
  facts +=
      fact("command", run.command) + fact("started", run.started) + fact("host", run.host) + fact("input", run.input);
  facts += fact("output", run.output) + fact("store", run.store);
  if (run.threads > 0) facts += fact("threads", std::to_string(run.threads));
  if (run.peak_memory_bytes > 0) facts += fact("peak memory", fmt::format("{} MB", run.peak_memory_bytes >> 20));
  for (const auto& [name, value] : run.more) facts += fact(name, value);
  std::string out = "<h2>The run</h2><div class=\"two\"><div class=\"card\"><table class=\"facts\">" + facts +
                    "</table></div><div class=\"card\"><h3>Processor time by stage</h3>" + stage_times(record) +
                    "</div></div>";
  if (!record.settings_yaml.empty())
    out += "<details><summary>Settings as used</summary><pre>" + escaped(record.settings_yaml) + "</pre></details>";
  return out;
}

}  // namespace

std::string html_report(const SurveyRecord& record) {
  const SurveyCounts c = count(record);
  const Headline head = headline(c);
  const std::string title = record.title.empty() ? "survey" : record.title;
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">";
  page += fmt::format("<title>{} – Isthmus</title><style>{}</style></head><body><main>", escaped(title), kPageStyle);
  page += fmt::format("<header><b>Isthmus</b><span>{}</span><span>{}</span></header>", escaped(title),
                      escaped(record.run.started));
  page += fmt::format("<h1 class=\"{}\">{}</h1>", head.grade, head.text);
  page += "<p class=\"lead\">" + escaped(summary_text(record, c)) + "</p>";
  page += tiles(record, c);
  const std::string missing = missing_section(record);
  if (!missing.empty()) page += "<h2>Not joined</h2>" + missing;
  const std::string control = control_section(record);
  if (!control.empty()) page += "<h2>Control</h2>" + control;
  page += maps(record) + view_section(record) + pairs_section(record) + links_section(record, c);
  page += "<h2>Scans</h2><div class=\"scroll\">" + scan_table(record) + "</div>";
  page += warnings_section(record) + run_section(record);
  page += fmt::format("</main><script>{}</script>", kPageScript);
  page += view_script(record) + "</body></html>\n";
  return page;
}

}  // namespace isthmus::report
