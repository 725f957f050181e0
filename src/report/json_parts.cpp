#include "report/json_parts.h"

#include <numbers>

namespace isthmus::report {
namespace {

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

const char* kind_word(ControlKind kind) {
  return kind == ControlKind::point ? "point" : kind == ControlKind::pose ? "pose" : "levelled";
}

}  // namespace

Json counts_json(const SurveyCounts& c) {
  return {{"scans", c.scans},
          {"placed", c.placed},
          {"unplaced", c.unplaced},
          {"failed", c.failed},
          {"components", c.components},
          {"largest_component", c.in_largest},
          {"pairs", c.pairs},
          {"accepted", c.accepted},
          {"ambiguous", c.ambiguous},
          {"rejected", c.rejected},
          {"pairs_failed", c.pairs_failed},
          {"promoted_by_loops", c.promoted},
          {"rejected_by_loops", c.overruled},
          {"confirmed_by_loops", c.confirmed}};
}

Json versions_json(const SurveyRecord& record) {
  Json out = Json::object();
  for (const auto& [name, version] : record.versions) out[name] = version;
  return out;
}

Json warnings_json(const SurveyRecord& record) {
  Json warnings = record.warnings;
  for (const std::string& warning : record.solution.warnings) warnings.push_back(warning);
  return warnings;
}

void add_frame(const Component& component, Json& to) {
  if (!component.georeference) return;
  to["frame"] = component.georeference->levelled_only ? "levelled" : "world";
  to["datum_shift_m"] = vector_json(component.georeference->shift_m);
}

Json edits_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (const SolvedLink& l : record.solution.links) {
    if (l.link.by_hand == ByHand::nothing) continue;
    out.push_back({{"link", word(l.link.by_hand)},
                   {"source", find_scan(record, l.link.source)->name},
                   {"target", find_scan(record, l.link.target)->name},
                   {"verdict", word(l.link.result.verdict)}});
  }
  return out;
}

Json control_json(const SurveyRecord& record) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  Json out = Json::array();
  for (const ControlResult& r : record.solution.control) {
    const ScanRecord* scan = find_scan(record, r.scan);
    Json item = {
        {"name", r.name}, {"kind", kind_word(r.kind)}, {"scan", scan != nullptr ? scan->name : ""}, {"used", r.used}};
    if (!r.reason.empty()) item["reason"] = r.reason;
    if (r.before) item["before_m"] = vector_json(*r.before);
    if (r.after) item["after_m"] = vector_json(*r.after);
    if (r.before_rad) item["before_deg"] = *r.before_rad * kDegPerRad;
    if (r.after_rad) item["after_deg"] = *r.after_rad * kDegPerRad;
    out.push_back(std::move(item));
  }
  return out;
}

Json run_section(const RunRecord& run) {
  Json out = {{"command", run.command},    {"started", run.started}, {"host", run.host},
              {"input", run.input},        {"output", run.output},   {"store", run.store},
              {"threads", run.threads},    {"seconds", run.seconds}, {"peak_memory_bytes", run.peak_memory_bytes},
              {"exit_code", run.exit_code}};
  out["warnings"] = run.warnings;
  for (const auto& [name, value] : run.more) out[name] = value;
  return out;
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

}  // namespace isthmus::report
