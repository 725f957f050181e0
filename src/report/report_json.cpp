#include "report/report_json.h"

#include <cmath>
#include <numbers>

#include "report/charts.h"
#include "report/json_parts.h"
#include "report/loop_closures.h"
#include "report/verdict_words.h"

namespace isthmus::report {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

Json number(double value) { return std::isfinite(value) ? Json(value + 0.0) : Json(nullptr); }

template <class T>
Json number(const std::optional<T>& value) {
  return value ? number(static_cast<double>(*value)) : Json(nullptr);
}

Json rows_of(const Transform& t) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({t(row, 0) + 0.0, t(row, 1) + 0.0, t(row, 2) + 0.0, t(row, 3) + 0.0});
  return rows;
}

Json terms_json(const std::vector<std::pair<std::string, double>>& terms) {
  Json out = Json::object();
  for (const auto& [name, value] : terms) out[name] = number(value);
  return out;
}

Json point_json(const Eigen::Vector3d& p) { return {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}; }

/// The link that came nearest to joining the component with the rest.
Json best_open_link_json(const SurveyRecord& record, int component) {
  const SolvedLink* best = best_open_link(record, component);
  if (best == nullptr) return nullptr;
  const PairResult& r = best->link.result;
  Json out = {{"source", best->link.source},
              {"target", best->link.target},
              {"verdict", word(r.verdict)},
              {"probability", number(r.probability)}};
  out["overlap"] = r.target_from_source ? number(r.overlap) : Json(nullptr);
  out["reason"] = r.reason;
  return out;
}

Json components_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (std::size_t k = 0; k < record.solution.components.size(); ++k) {
    const Component& component = record.solution.components[k];
    Json entry = {{"anchor", component.anchor}, {"scans", component.scans}};
    add_frame(component, entry);
    entry["nearest_to_joining"] = best_open_link_json(record, static_cast<int>(k));
    out.push_back(std::move(entry));
  }
  return out;
}

Json scan_json(const SurveyRecord& record, const ScanRecord& scan) {
  const PlacedScan* placed = record.solution.find(scan.id);
  Json out = {{"id", scan.id}, {"name", scan.name}, {"status", word(scan.status)}, {"reason", scan.reason}};
  out["component"] = placed != nullptr ? Json(placed->component) : Json(nullptr);
  out["pose"] = scan.status == ScanStatus::placed ? rows_of(component_from_scan(record, scan.id)) : Json(nullptr);
  out["sigma_m"] = placed != nullptr ? number(placed->sigma_m) : Json(nullptr);
  out["sigma_deg"] = placed != nullptr && placed->sigma_rad ? number(*placed->sigma_rad * kDegPerRad) : Json(nullptr);
  out["format"] = scan.format;
  out["points_read"] = scan.num_read;
  out["points_dropped"] = scan.num_dropped;
  out["points"] = scan.points;
  out["spacing_m"] = number(scan.spacing_m);
  out["station"] = word(scan.station_kind);
  out["station_in_scan"] =
      scan.station_kind == StationKind::unknown ? Json(nullptr) : point_json(scan.local_origin_in_scan + scan.station);
  out["radius_m"] = number(scan.radius_m);
  out["notes"] = scan.notes;
  out["seconds"] = terms_json(scan.seconds);
  return out;
}

Json loop_json(const std::optional<LoopClosure>& loop) {
  if (!loop) return nullptr;
  return {{"via", loop->via},
          {"error_m", number(loop->translation_m)},
          {"error_deg", number(loop->rotation_rad * kDegPerRad)}};
}

Json off_poses_json(const std::optional<LinkError>& error) {
  if (!error) return nullptr;
  return {{"m", number(error->translation_m)}, {"deg", number(error->rotation_rad * kDegPerRad)}};
}

Json link_json(const SurveyRecord& record, const SolvedLink& l, const LoopClosures& loops) {
  const PairResult& r = l.link.result;
  const auto measured = [&](double value) {
    return r.target_from_source && l.link.by_hand != ByHand::added ? number(value) : Json(nullptr);
  };
  Json out = {{"source", l.link.source}, {"target", l.link.target}};
  out["verdict"] = word(r.verdict);
  out["verdict_of_pair"] = word(l.measured);
  out["reason"] = r.reason;
  out["probability"] = number(r.probability);
  out["probability_with_loops"] = number(l.probability);
  out["overlap"] = measured(r.overlap);
  out["overlap_of_source"] = measured(r.overlap_of_source);
  out["overlap_of_target"] = measured(r.overlap_of_target);
  out["rms_m"] = measured(r.rms_m);
  for (const char* name : {"share_under_6mm", "share_under_20mm", "observability"})
    out[name] = number(evidence_term(r, name));
  out["loop"] = loop_json(loops.of(l.link));
  out["off_poses"] = off_poses_json(l.after);
  out["off_poses_before"] = off_poses_json(l.before);
  out["in_loop"] = l.in_loop;
  out["guided"] = l.link.guided;
  out["by_hand"] = word(l.link.by_hand);
  const bool placed = r.target_from_source && find_scan(record, l.link.source) != nullptr &&
                      find_scan(record, l.link.target) != nullptr;
  out["target_from_source"] = placed ? rows_of(target_from_source_in_scans(record, l.link)) : Json(nullptr);
  out["evidence"] = terms_json(r.evidence);
  out["counts"] = terms_json(r.counts);
  out["seconds"] = terms_json(r.seconds_by_stage);
  return out;
}

Json bins_json(const VerdictBins& bins) {
  Json out = {{"bin_width", bins.bin_width}};
  constexpr std::array<const char*, 3> kNames = {"accepted", "ambiguous", "rejected"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    Json counts = Json::array();
    for (const auto& bin : bins.counts) counts.push_back(bin[k]);
    out[kNames[k]] = std::move(counts);
  }
  return out;
}

}  // namespace

std::string report_json(const SurveyRecord& record) {
  const SurveyCounts counts = count(record);
  const Headline head = headline(counts);
  Json json = {{"title", record.title}};
  json["verdict"] = {{"grade", head.grade}, {"headline", head.text}, {"summary", summary_text(record, counts)}};
  json["voxel_m"] = record.voxel_m;
  json["counts"] = counts_json(counts);
  json["components"] = components_json(record);
  json["scans"] = Json::array();
  for (const ScanRecord& scan : record.scans) json["scans"].push_back(scan_json(record, scan));
  json["links"] = Json::array();
  const LoopClosures loops(record);
  for (const SolvedLink& l : record.solution.links) json["links"].push_back(link_json(record, l, loops));
  json["histograms"]["overlap"] = bins_json(overlap_bins(record));
  json["histograms"]["rms_m"] = bins_json(residual_bins(record));
  json["histograms"]["loop_error_m"] = bins_json(loop_bins(record));
  json["edits"] = edits_json(record);
  json["control"] = control_json(record);
  json["warnings"] = warnings_json(record);
  json["settings"] = record.settings_yaml;
  json["versions"] = versions_json(record);
  json["seconds_by_stage"] = terms_json(seconds_by_stage(record));
  json["run"] = run_section(record.run);
  return text_of(json);
}

}  // namespace isthmus::report
