#include "report/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "report/html_text.h"
#include "report/loop_closures.h"
#include "survey/candidates.h"

namespace isthmus::report {
namespace {

constexpr double kMatrixPx = 560;
constexpr double kLargestCellPx = 44;
constexpr std::size_t kMaxLabelled = 40;

/// Scans that were read, by component, then in natural order of their names.
std::vector<int> matrix_order(const SurveyRecord& record) {
  std::vector<int> ids;
  for (const Component& component : record.solution.components) {
    ids.insert(ids.end(), component.scans.begin(), component.scans.end());
    // Neighbours in the field often are neighbours in the naming, so that links gather along the diagonal.
    std::stable_sort(ids.end() - static_cast<std::ptrdiff_t>(component.scans.size()), ids.end(), [&](int a, int b) {
      return natural_less(find_scan(record, a)->name, find_scan(record, b)->name);
    });
  }
  return ids;
}

std::string verdict_class(const SolvedLink& link) {
  const PairResult& r = link.link.result;
  if (r.verdict == Verdict::accepted) return fmt::format("accepted c{}", probability_class(link.probability));
  return word(r.verdict);
}

constexpr std::array<const char*, 3> kStack{"accepted", "ambiguous", "rejected"};

int stack_of(Verdict verdict) { return verdict == Verdict::accepted ? 0 : verdict == Verdict::ambiguous ? 1 : 2; }

struct Measured {
  double value;
  Verdict verdict;
};

VerdictBins binned(const std::vector<Measured>& all, double bin_width) {
  VerdictBins bars;
  bars.bin_width = bin_width;
  for (const Measured& m : all) {
    const double bin = std::clamp(std::floor(m.value / bin_width), 0.0, kNumBins - 1.0);
    ++bars.counts[static_cast<std::size_t>(bin)][stack_of(m.verdict)];
  }
  return bars;
}

template <class Value>
std::vector<Measured> measured(const SurveyRecord& record, Value value) {
  std::vector<Measured> all;
  for (const SolvedLink& l : record.solution.links) {
    const PairResult& r = l.link.result;
    if (r.target_from_source && r.verdict != Verdict::failed) all.push_back({value(r), r.verdict});
  }
  return all;
}

/// With nine such bins, nineteen in twenty of the accepted links (without any: of all) lie before the last.
double fitting_width(const std::vector<Measured>& all, double voxel_m) {
  constexpr double kShare = 0.95;
  std::vector<double> values;
  for (const Verdict least : {Verdict::accepted, Verdict::failed}) {
    for (const Measured& m : all)
      if (m.verdict >= least) values.push_back(m.value);
    if (!values.empty()) break;
  }
  std::ranges::sort(values);
  const double reach =
      values.empty() ? 0 : values[static_cast<std::size_t>(kShare * static_cast<double>(values.size() - 1))];
  if (!(reach > 0)) return (voxel_m > 0 ? voxel_m : 1.0) / kNumBins;
  const double wanted = reach / (kNumBins - 1), power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power > wanted) return step * power;
  return 10 * power;
}

std::array<std::string, 3> axis_of_lengths(double bin_width) {
  return {"0", metres(bin_width * kNumBins / 2), "over " + metres(bin_width * (kNumBins - 1))};
}

std::string bar_chart(const VerdictBins& bars, const std::array<std::string, 3>& axis, const std::string& caption) {
  constexpr double kWidth = 420, kHeight = 150, kBase = 126, kTop = 14;
  int largest = 1;
  for (const auto& bin : bars.counts) largest = std::max(largest, std::accumulate(bin.begin(), bin.end(), 0));
  std::string out = fmt::format("<figure><svg class=\"bars\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">",
                                kWidth, kHeight, escaped(caption));
  for (int b = 0; b < kNumBins; ++b) {
    const double x = 10 + b * 40.0;
    double y = kBase;
    int total = 0;
    for (int k = 0; k < 3; ++k) {
      const int count = bars.counts[b][k];
      const double height = (kBase - kTop) * count / largest;
      y -= height;
      total += count;
      if (count > 0)
        fmt::format_to(
            std::back_inserter(out),
            "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"36\" height=\"{:.1f}\"><title>{} {}</title></rect>",
            kStack[k], x, y, height, count, kStack[k]);
    }
    if (total > 0)
      fmt::format_to(std::back_inserter(out), "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x + 18, y - 3, total);
  }
  fmt::format_to(std::back_inserter(out), "<line class=\"axis\" x1=\"8\" y1=\"{0}\" x2=\"412\" y2=\"{0}\"/>",
                 kBase + 0.5);
  for (int k = 0; k < 3; ++k)
    fmt::format_to(std::back_inserter(out), "<text class=\"tick t{}\" x=\"{}\" y=\"{}\">{}</text>", k, 10 + 200 * k,
                   kHeight - 8, escaped(axis[k]));
  return out + fmt::format("</svg><figcaption>{}</figcaption></figure>", escaped(caption));
}

}  // namespace

std::string pair_matrix(const SurveyRecord& record) {
  const std::vector<int> ids = matrix_order(record);
  const std::size_t n = ids.size();
  if (n < 2) return {};
  const bool labelled = n <= kMaxLabelled;
  const double label = labelled ? 92 : 8;
  const double cell = std::min(kLargestCellPx, (kMatrixPx - label) / static_cast<double>(n));
  const double size = label + cell * static_cast<double>(n) + 4;
  std::map<int, std::size_t> place;
  for (std::size_t k = 0; k < n; ++k) place[ids[k]] = k;
  std::string svg = fmt::format(
      "<svg class=\"matrix\" viewBox=\"0 0 {0:.0f} {0:.0f}\" style=\"max-width:{0:.0f}px\" role=\"img\" "
      "aria-label=\"Matrix of tried pairs\">",
      size);
  const auto square = [&](std::size_t row, std::size_t column, const std::string& css, double opacity,
                          const std::string& title, const std::string& data) {
    fmt::format_to(
        std::back_inserter(svg),
        "<rect class=\"{}\" {} x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill-opacity=\"{:.2f}\">"
        "<title>{}</title></rect>",
        css, data, label + cell * static_cast<double>(column) + 0.5, label + cell * static_cast<double>(row) + 0.5,
        cell - 1, cell - 1, opacity, escaped(title));
  };
  fmt::format_to(std::back_inserter(svg),
                 "<rect class=\"sheet\" x=\"{0:.1f}\" y=\"{0:.1f}\" width=\"{1:.1f}\" height=\"{1:.1f}\"/>", label,
                 cell * static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k) {
    const std::string& name = find_scan(record, ids[k])->name;
    square(k, k, "diagonal", 1.0, name, fmt::format("data-scan=\"{}\"", ids[k]));
    if (!labelled) continue;
    const double at = label + cell * (static_cast<double>(k) + 0.5);
    fmt::format_to(std::back_inserter(svg), "<text class=\"row\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", label - 6,
                   at + 3.5, escaped(short_name(name, 13)));
    fmt::format_to(std::back_inserter(svg),
                   "<text class=\"column\" transform=\"translate({:.1f} {:.1f}) rotate(-90)\">{}</text>", at + 3.5,
                   label - 6, escaped(short_name(name, 13)));
  }
  for (const SolvedLink& l : record.solution.links) {
    const auto a = place.find(l.link.source), b = place.find(l.link.target);
    if (a == place.end() || b == place.end()) continue;
    const auto [low, high] = std::minmax(a->second, b->second);
    const std::string title = link_title(record, l);
    const std::string data = fmt::format("data-link=\"{}-{}\"", l.link.source, l.link.target);
    square(high, low, verdict_class(l), 1.0, title, data);
    if (l.link.result.target_from_source && l.link.result.verdict >= Verdict::ambiguous)
      square(low, high, "overlap", std::clamp(0.08 + 1.2 * l.link.result.overlap, 0.0, 1.0), title, data);
  }
  return svg + "</svg>";
}

VerdictBins overlap_bins(const SurveyRecord& record) {
  return binned(measured(record, [](const PairResult& r) { return r.overlap; }), 1.0 / kNumBins);
}

VerdictBins residual_bins(const SurveyRecord& record) {
  const std::vector<Measured> all = measured(record, [](const PairResult& r) { return r.rms_m; });
  return binned(all, fitting_width(all, record.voxel_m));
}

VerdictBins loop_bins(const SurveyRecord& record) {
  const LoopClosures loops(record);
  std::vector<Measured> all;
  for (const SolvedLink& l : record.solution.links) {
    const std::optional<LoopClosure> loop = loops.of(l.link);
    if (loop && l.link.result.verdict != Verdict::failed) all.push_back({loop->translation_m, l.link.result.verdict});
  }
  return binned(all, fitting_width(all, record.voxel_m));
}

std::string overlap_histogram(const SurveyRecord& record) {
  return bar_chart(overlap_bins(record), {"0 %", "50 %", "100 %"},
                   "Overlap of the tried pairs (the smaller of both directions)");
}

std::string residual_histogram(const SurveyRecord& record) {
  const VerdictBins bins = residual_bins(record);
  return bar_chart(bins, axis_of_lengths(bins.bin_width), "Residual over the overlap (point to plane, rms)");
}

std::string loop_histogram(const SurveyRecord& record) {
  const VerdictBins bins = loop_bins(record);
  return bar_chart(bins, axis_of_lengths(bins.bin_width),
                   "Error of the shortest loop of other links through each link");
}

Seconds seconds_by_stage(const SurveyRecord& record) {
  Seconds sums;
  const auto add = [&](const Seconds& seconds) {
    for (const auto& [stage, value] : seconds) {
      const auto at = std::find_if(sums.begin(), sums.end(), [&](const auto& s) { return s.first == stage; });
      if (at == sums.end())
        sums.emplace_back(stage, value);
      else
        at->second += value;
    }
  };
  for (const ScanRecord& scan : record.scans) add(scan.seconds);
  for (const SolvedLink& l : record.solution.links) add(l.link.result.seconds_by_stage);
  return sums;
}

std::string stage_times(const SurveyRecord& record) {
  const Seconds sums = seconds_by_stage(record);
  double largest = 0;
  for (const auto& [stage, value] : sums) largest = std::max(largest, value);
  if (largest <= 0) return "<p class=\"quiet\">Nothing was computed in this run: everything came from the store.</p>";
  std::string out = "<table class=\"times\">";
  for (const auto& [stage, value] : sums)
    fmt::format_to(std::back_inserter(out),
                   "<tr><th>{}</th><td class=\"n\">{}</td><td class=\"bar\"><i style=\"width:{:.1f}%\"></i></td></tr>",
                   escaped(stage), duration(value), 100.0 * value / largest);
  return out + "</table>";
}

}  // namespace isthmus::report
