#include "report/plan_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "report/html_text.h"

namespace isthmus::report {
namespace {

struct Sheet {
  double width, height, margin;
};
constexpr Sheet kLarge{1080, 620, 56};
constexpr Sheet kSmall{520, 340, 44};
constexpr double kLeastHeight = 0.55;  // of a large sheet: what a row of stations leaves empty is cut off
// Stations whose least spread is along z within this angle count as a level survey.
constexpr double kLevelCosine = 0.94;  // 20 degrees
constexpr std::size_t kManyScans = 40;
// Beyond this an ambiguous link contradicts the poses.
constexpr double kOffVoxels = 4.0;
// Discs wider than this share of the sheet would hide it: objects turned before one scanner all overlap.
constexpr double kWidestFootprint = 0.45;

struct Spot {
  Eigen::Vector2d at;  // px
  double radius_px = 0;
};

/// Rows: the map's right and up in the component's frame.
Eigen::Matrix<double, 2, 3> view_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix<double, 2, 3> from_above;
  from_above << 1, 0, 0, 0, 1, 0;
  if (points.size() < 3) return from_above;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  const Eigen::Vector3d least = eigen.eigenvectors().col(0);
  // A line of stations spreads in one direction only and says nothing about which way is up.
  const bool line = eigen.eigenvalues()[1] < 1e-3 * eigen.eigenvalues()[2];
  if (line || std::abs(least.z()) > kLevelCosine) return from_above;
  const auto signed_axis = [](Eigen::Vector3d axis) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    return Eigen::Vector3d(axis[largest] < 0 ? -axis : axis);
  };
  from_above.row(0) = signed_axis(eigen.eigenvectors().col(2)).transpose();
  from_above.row(1) = signed_axis(eigen.eigenvectors().col(1)).transpose();
  return from_above;
}

struct Layout {
  std::map<int, Spot> spots;  // by id
  double px_per_m = 1;
};

/// Lowers a sheet that may shrink to what the stations need.
Layout laid_out(const SurveyRecord& record, const Component& component, bool may_shrink, Sheet& sheet) {
  std::vector<Eigen::Vector3d> stations;
  for (const int id : component.scans) stations.push_back(station_in_component(record, *find_scan(record, id)));
  Eigen::Matrix<double, 2, 3> view = view_of(stations);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = -low;
  for (const Eigen::Vector3d& p : stations) low = low.cwiseMin(view * p), high = high.cwiseMax(view * p);
  if (high.y() - low.y() > high.x() - low.x()) {  // headings mean nothing here: lay the long side along the sheet
    const Eigen::RowVector3d right = view.row(0);
    view.row(0) = view.row(1);
    view.row(1) = -right;
    low = Eigen::Vector2d::Constant(1e300), high = -low;
    for (const Eigen::Vector3d& p : stations) low = low.cwiseMin(view * p), high = high.cwiseMax(view * p);
  }
  const Eigen::Vector2d span = (high - low).cwiseMax(1e-9);
  Layout layout;
  layout.px_per_m = std::min((sheet.width - 2 * sheet.margin) / span.x(), (sheet.height - 2 * sheet.margin) / span.y());
  if (may_shrink)
    sheet.height = std::clamp(span.y() * layout.px_per_m + 2 * sheet.margin, kLeastHeight * sheet.height, sheet.height);
  const Eigen::Vector2d middle = 0.5 * (low + high);
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Eigen::Vector2d p = (view * stations[k] - middle) * layout.px_per_m;
    const double radius = find_scan(record, component.scans[k])->radius_m * layout.px_per_m;
    layout.spots[component.scans[k]] = {{sheet.width / 2 + p.x(), sheet.height / 2 - p.y()}, radius};
  }
  return layout;
}

void draw_footprints(std::string& svg, const Layout& layout, const Sheet& sheet) {
  double widest = 0;
  for (const auto& [id, spot] : layout.spots) widest = std::max(widest, spot.radius_px);
  if (widest > kWidestFootprint * sheet.height && layout.spots.size() > 2) return;
  svg += "<g class=\"footprints\">";
  for (const auto& [id, spot] : layout.spots)
    fmt::format_to(std::back_inserter(svg), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>", spot.at.x(),
                   spot.at.y(), std::min(kWidestFootprint * sheet.height, spot.radius_px));
  svg += "</g>";
}

/// An ambiguous link that the poses contradict says nothing about the survey: it is drawn with the rejected ones.
const char* map_class(const SolvedLink& l, double voxel_m) {
  const Verdict verdict = l.link.result.verdict;
  const bool off = l.after && l.after->translation_m > kOffVoxels * voxel_m;
  return verdict == Verdict::ambiguous && off ? "rejected" : word(verdict);
}

void draw_links(std::string& svg, const SurveyRecord& record, const Layout& layout, bool large) {
  svg += "<g class=\"links\">";
  const auto draw = [&](Verdict verdict) {
    for (const SolvedLink& l : record.solution.links) {
      const auto a = layout.spots.find(l.link.source), b = layout.spots.find(l.link.target);
      const PairResult& r = l.link.result;
      if (r.verdict != verdict || a == layout.spots.end() || b == layout.spots.end()) continue;
      // Width by overlap: a wide isthmus is a strong one.
      const double width = (large ? 1.6 : 1.2) + 5.0 * std::clamp(r.overlap, 0.0, 1.0);
      fmt::format_to(
          std::back_inserter(svg),
          "<line class=\"link {} p{} r{}{}\" data-link=\"{}-{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" "
          "y2=\"{:.1f}\" stroke-width=\"{:.1f}\"><title>{}</title></line>",
          map_class(l, record.voxel_m), probability_class(l.probability), residual_class(r.rms_m, record.voxel_m),
          l.in_loop || verdict != Verdict::accepted ? "" : " bridge", l.link.source, l.link.target, a->second.at.x(),
          a->second.at.y(), b->second.at.x(), b->second.at.y(), width, escaped(link_title(record, l)));
    }
  };
  draw(Verdict::rejected);
  draw(Verdict::ambiguous);
  draw(Verdict::accepted);
  svg += "</g>";
}

/// Median distance of a station to its nearest neighbour on the sheet.
double typical_gap_px(const Layout& layout) {
  std::vector<double> gaps;
  for (const auto& [id, spot] : layout.spots) {
    double nearest = 1e300;
    for (const auto& [other, its] : layout.spots)
      if (other != id) nearest = std::min(nearest, (spot.at - its.at).norm());
    gaps.push_back(nearest);
  }
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

/// Keeps labels from covering dots and each other: those that find no room are left out (the tooltip has the name).
class LabelRoom {
 public:
  explicit LabelRoom(double width) : width_(width) {}
  void keep_free(const Eigen::Vector2d& dot, double radius) {
    taken_.push_back({dot.x() - radius, dot.x() + radius, dot.y() - radius, dot.y() + radius});
  }
  static double length(std::size_t letters, double font_px) { return 0.58 * font_px * static_cast<double>(letters); }
  bool take(const Eigen::Vector2d& corner, double length, double font_px) {
    const Box box{corner.x(), corner.x() + length, corner.y() - font_px, corner.y()};
    if (box.left < 0 || box.right > width_) return false;
    for (const Box& b : taken_)
      if (box.left < b.right && b.left < box.right && box.top < b.bottom && b.top < box.bottom) return false;
    taken_.push_back(box);
    return true;
  }

 private:
  struct Box {
    double left, right, top, bottom;
  };
  double width_;  // of the sheet
  std::vector<Box> taken_;
};

std::string station_title(const ScanRecord& scan, const PlacedScan& placed, bool anchor) {
  std::string title = fmt::format("{} (id {})\n{} points", scan.name, scan.id, large_number(scan.points));
  if (anchor) title += "\nanchor: its frame is the frame of this part";
  if (placed.sigma_m) title += fmt::format("\nposition known to {}", metres(*placed.sigma_m));
  return title;
}

void draw_stations(std::string& svg, const SurveyRecord& record, const Component& component, const Layout& layout,
                   const Sheet& sheet, bool large) {
  const bool many = component.scans.size() > kManyScans;
  const double radius = std::clamp(0.3 * typical_gap_px(layout), 2.5, large ? 7.5 : 6.0);
  const double font_px = many ? 9.5 : 12;
  LabelRoom room(sheet.width);
  fmt::format_to(std::back_inserter(svg), "<g class=\"stations{}\">", many ? " many" : "");
  for (const auto& [id, spot] : layout.spots) {
    const ScanRecord& scan = *find_scan(record, id);
    const bool anchor = id == component.anchor;
    fmt::format_to(std::back_inserter(svg),
                   "<g class=\"station{}\" data-scan=\"{}\" tabindex=\"0\" role=\"button\"><title>{}</title>",
                   anchor ? " anchor" : "", id, escaped(station_title(scan, *record.solution.find(id), anchor)));
    if (anchor)
      fmt::format_to(std::back_inserter(svg), "<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>",
                     spot.at.x(), spot.at.y(), radius + 4);
    fmt::format_to(std::back_inserter(svg), "<circle class=\"dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>",
                   spot.at.x(), spot.at.y(), radius);
    svg += "</g>";
    room.keep_free(spot.at, radius);
  }
  for (const auto& [id, spot] : layout.spots) {
    const std::string label = many ? fmt::format("{}", id) : short_name(find_scan(record, id)->name, 14);
    const double length = LabelRoom::length(label.size(), font_px), off = radius + 4;
    for (const Eigen::Vector2d& shift :
         {Eigen::Vector2d(off, -radius), Eigen::Vector2d(-off - length, -radius),
          Eigen::Vector2d(off, radius + font_px), Eigen::Vector2d(-off - length, radius + font_px)})
      if (const Eigen::Vector2d corner = spot.at + shift; room.take(corner, length, font_px)) {
        fmt::format_to(std::back_inserter(svg), "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", corner.x(),
                       corner.y(), escaped(label));
        break;
      }
  }
  svg += "</g>";
}

/// The largest 1, 2 or 5 times a power of ten that fits in a fifth of the sheet.
void draw_scale(std::string& svg, const Layout& layout, const Sheet& sheet) {
  const double room_m = 0.2 * sheet.width / layout.px_per_m;
  const double power = std::pow(10.0, std::floor(std::log10(room_m)));
  const double length_m = (room_m >= 5 * power ? 5 : room_m >= 2 * power ? 2 : 1) * power;
  const double x = 18, y = sheet.height - 18, length = length_m * layout.px_per_m;
  const std::string text = length_m < 0.01 ? fmt::format("{:g} mm", length_m * 1e3) : fmt::format("{:g} m", length_m);
  fmt::format_to(std::back_inserter(svg),
                 "<g class=\"scale\"><path d=\"M{:.1f} {:.1f}v-6m0 6h{:.1f}m0 0v-6\"/><text x=\"{:.1f}\" "
                 "y=\"{:.1f}\">{}</text></g>",
                 x, y, length, x + length + 8, y + 1, text);
}

}  // namespace

Eigen::Vector3d station_in_component(const SurveyRecord& record, const ScanRecord& scan) {
  const Eigen::Vector3d& p = scan.station_kind == StationKind::unknown ? scan.centre : scan.station;
  return record.solution.find(scan.id)->component_from_local * p;
}

Eigen::Vector3d up_of_plan(const SurveyRecord& record, int component) {
  std::vector<Eigen::Vector3d> stations;
  for (const int id : record.solution.components[component].scans)
    stations.push_back(station_in_component(record, *find_scan(record, id)));
  const Eigen::Matrix<double, 2, 3> view = view_of(stations);
  return Eigen::Vector3d(view.row(0)).cross(Eigen::Vector3d(view.row(1))).normalized();
}

std::string plan_map_svg(const SurveyRecord& record, int component, bool large) {
  const Component& part = record.solution.components[component];
  Sheet sheet = large ? kLarge : kSmall;
  const Layout layout = laid_out(record, part, large, sheet);
  std::string svg = fmt::format(
      "<svg class=\"plan\" viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"Plan of part {} with {} stations\">",
      sheet.width, sheet.height, component, part.scans.size());
  draw_footprints(svg, layout, sheet);
  draw_links(svg, record, layout, large);
  draw_stations(svg, record, part, layout, sheet, large);
  draw_scale(svg, layout, sheet);
  return svg + "</svg>";
}

std::string plan_map_legend() {
  std::string out =
      "<div class=\"legend\"><span class=\"switch\">Colour links by "
      "<label><input type=\"radio\" name=\"hue\" value=\"p\" checked> probability</label>"
      "<label><input type=\"radio\" name=\"hue\" value=\"r\"> residual</label></span><span class=\"keys by-p\">";
  for (int c = 0; c < kNumClasses; ++c) out += fmt::format("<i class=\"swatch c{}\"></i>{} ", c, probability_bound(c));
  out += "</span><span class=\"keys by-r\">";
  for (int c = 0; c < kNumClasses; ++c) out += fmt::format("<i class=\"swatch c{}\"></i>{} ", c, residual_bound(c));
  return out +
         "</span><span class=\"keys\"><svg class=\"key\" viewBox=\"0 0 34 10\"><line class=\"link ambiguous p3\" "
         "x1=\"1\" y1=\"5\" "
         "x2=\"33\" y2=\"5\" stroke-width=\"3\"/></svg>ambiguous "
         "<svg class=\"key\" viewBox=\"0 0 34 10\"><line class=\"link accepted bridge p0\" x1=\"1\" y1=\"5\" x2=\"33\" "
         "y2=\"5\" "
         "stroke-width=\"3\"/></svg>no loop confirms it "
         "<svg class=\"key round\" viewBox=\"0 0 24 24\"><g class=\"station anchor\"><circle class=\"ring\" cx=\"12\" "
         "cy=\"12\" "
         "r=\"10\"/><circle class=\"dot\" cx=\"12\" cy=\"12\" r=\"6\"/></g></svg>anchor; width: overlap</span>"
         "<label class=\"switch\"><input type=\"checkbox\" id=\"show-rejected\"> show links that the poses "
         "contradict</label></div>";
}

}  // namespace isthmus::report
