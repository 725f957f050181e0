#include "report/view_section.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "report/html_text.h"
#include "report/json_parts.h"
#include "report/plan_map.h"
#include "report/verdict_words.h"
#include "report/view_script.h"

namespace isthmus::report {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto at = [&](std::size_t k) {
    return k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) : 0U;
  };
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::uint32_t three = at(k) << 16U | at(k + 1) << 8U | at(k + 2);
    for (const unsigned shift : {18U, 12U, 6U, 0U}) out += kDigits[three >> shift & 63U];
  }
  for (std::size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k) out[out.size() - 1 - k] = '=';
  return out;
}

/// Micrometres are beyond every screen.
double rounded(double metres_value) { return std::round(metres_value * 1e6) / 1e6 + 0.0; }

Json point_json(const Eigen::Vector3d& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

bool is_shown(const SurveyRecord& record, const ScanRecord& scan) {
  return scan.status == ScanStatus::placed && record.solution.find(scan.id) != nullptr;
}

bool has_view(const SurveyRecord& record) {
  return std::string_view(kViewScript).size() > 0 && std::ranges::any_of(record.scans, [&](const ScanRecord& scan) {
           return is_shown(record, scan) && scan.view.num_points > 0;
         });
}

/// Median distance of the station's accepted links from the solved poses.
std::optional<double> error_of(const SurveyRecord& record, int id) {
  std::vector<double> off;
  for (const SolvedLink& l : record.solution.links) {
    if (l.link.result.verdict != Verdict::accepted || !l.after) continue;
    if (l.link.source == id || l.link.target == id) off.push_back(l.after->translation_m);
  }
  return off.empty() ? std::nullopt : std::optional<double>(median_of(off));
}

Json station_json(const SurveyRecord& record, const ScanRecord& scan) {
  const ViewCloud& cloud = scan.view;
  const std::optional<double> error = error_of(record, scan.id);
  Json out = {{"id", scan.id}, {"name", short_name(scan.name, 40)}};
  out["part"] = record.solution.find(scan.id)->component;
  out["at"] = point_json(station_in_component(record, scan));
  out["radius"] = rounded(scan.radius_m);
  out["error"] = error ? Json(rounded(*error)) : Json(nullptr);
  out["grade"] = error ? residual_class(*error, record.voxel_m) : 0;
  out["points"] = cloud.num_points;
  if (cloud.num_points == 0) return out;
  out["low"] = point_json(cloud.low);
  out["step"] = cloud.step_m;
  out["intensity"] = cloud.has_intensity;
  out["data"] = base64(cloud.bytes);
  return out;
}

Json links_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (const SolvedLink& l : record.solution.links) {
    const PairResult& r = l.link.result;
    Json link = {{"id", fmt::format("{}-{}", l.link.source, l.link.target)}};
    link["source"] = l.link.source;
    link["target"] = l.link.target;
    link["verdict"] = word(r.verdict);
    link["grade"] = probability_class(l.probability);
    link["rms"] = r.target_from_source ? Json(rounded(r.rms_m)) : Json(nullptr);
    out.push_back(std::move(link));
  }
  return out;
}

Json parts_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (std::size_t k = 0; k < record.solution.components.size(); ++k) {
    if (record.solution.components[k].scans.size() < 2) break;
    Json part = {{"number", k}};
    part["up"] = point_json(up_of_plan(record, static_cast<int>(k)));
    out.push_back(std::move(part));
  }
  return out;
}

std::string part_choice(const SurveyRecord& record) {
  std::string options;
  int parts = 0;
  for (const Component& part : record.solution.components) {
    if (part.scans.size() < 2) break;
    options +=
        fmt::format("<option value=\"{}\">{} ({} scans)</option>", parts,
                    parts == 0 ? std::string("the largest part") : fmt::format("part {}", parts), part.scans.size());
    ++parts;
  }
  return parts < 2 ? std::string() : "<label>show <select data-view=\"part\">" + options + "</select></label>";
}

}  // namespace

std::string view_data(const SurveyRecord& record) {
  double available = 0, kept = 0, spacing_m = record.voxel_m;
  Json stations = Json::array();
  for (const ScanRecord& scan : record.scans) {
    if (!is_shown(record, scan)) continue;
    stations.push_back(station_json(record, scan));
    available += static_cast<double>(scan.view.num_available);
    kept += static_cast<double>(scan.view.num_points);
    if (scan.view.num_points > 0) spacing_m = std::min(spacing_m, scan.view.spacing_m);
  }
  Json json = {{"voxel", spacing_m}};
  json["thinned"] = kept > 0 ? std::sqrt(available / kept) : 1.0;  // points stand this much farther apart
  json["errors"] = Json::array();
  for (int c = 0; c < kNumClasses; ++c) json["errors"].push_back(residual_bound(c));
  json["parts"] = parts_json(record);
  json["stations"] = std::move(stations);
  json["links"] = links_json(record);
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  // Inside a script element nothing may look like its end.
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      out.append("\\u003c");
    else
      out.push_back(c);
  }
  return out;
}

std::string view_section(const SurveyRecord& record) {
  if (!has_view(record)) {
    return record.no_view.empty()
               ? std::string()
               : "<h2>In space</h2><p class=\"quiet\">The scans are not shown here: " + escaped(record.no_view) +
                     ".</p>";
  }
  return "<h2>In space</h2><div class=\"card\" id=\"view\"><div class=\"view-bar\"><label>colour by <select "
         "data-view=\"colour\"><option value=\"station\">station</option><option value=\"height\">height</option>"
         "<option value=\"intensity\">intensity</option><option value=\"error\">error</option></select></label>" +
         part_choice(record) +
         "<label>cut above <input type=\"range\" data-view=\"cut\" min=\"0\" max=\"200\" value=\"200\"></label>"
         "<label><input type=\"checkbox\" data-view=\"links\" checked> links</label>"
         "<label><input type=\"checkbox\" data-view=\"alone\"> only what is selected</label>"
         "<button type=\"button\" data-view=\"above\">from above</button><button type=\"button\" "
         "data-view=\"home\">whole "
         "survey</button></div><canvas tabindex=\"0\" role=\"img\" aria-label=\"Scans, stations and links in space. "
         "Arrow "
         "keys turn, with Shift they shift; plus and minus zoom; N and P step through the stations; Home shows all.\">"
         "</canvas><p class=\"view-legend quiet\" aria-live=\"polite\">Unpacking the scans.</p></div>";
}

std::string view_script(const SurveyRecord& record) {
  if (!has_view(record)) return {};
  return "<script type=\"application/json\" id=\"view-data\">" + view_data(record) + "</script><script>" + kViewScript +
         "</script>";
}

}  // namespace isthmus::report
