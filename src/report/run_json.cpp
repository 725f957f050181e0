#include "report/run_json.h"

#include "report/json_parts.h"

namespace isthmus::report {
namespace {

Json components_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (const Component& component : record.solution.components) {
    Json names = Json::array();
    for (const int id : component.scans) names.push_back(find_scan(record, id)->name);
    Json one = {{"anchor", find_scan(record, component.anchor)->name}, {"scans", std::move(names)}};
    add_frame(component, one);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

SurveyCounts count(const SurveyRecord& record) {
  SurveyCounts c;
  c.scans = static_cast<int>(record.scans.size());
  for (const ScanRecord& scan : record.scans) {
    c.placed += scan.status == ScanStatus::placed;
    c.unplaced += scan.status == ScanStatus::unplaced;
    c.failed += scan.status == ScanStatus::failed;
  }
  for (const Component& component : record.solution.components) c.components += component.scans.size() >= 2;
  if (!record.solution.components.empty()) c.in_largest = static_cast<int>(record.solution.components[0].scans.size());
  c.pairs = static_cast<int>(record.solution.links.size());
  for (const SolvedLink& l : record.solution.links) {
    const Verdict verdict = l.link.result.verdict;
    c.accepted += verdict == Verdict::accepted;
    c.ambiguous += verdict == Verdict::ambiguous;
    c.rejected += verdict == Verdict::rejected;
    c.pairs_failed += verdict == Verdict::failed;
    c.promoted += verdict == Verdict::accepted && l.measured == Verdict::ambiguous;
    c.overruled += verdict == Verdict::rejected && l.measured == Verdict::accepted;
    c.confirmed += verdict == Verdict::accepted && l.in_loop;
  }
  return c;
}

std::string run_json(const SurveyRecord& record) {
  Json json;
  json["versions"] = versions_json(record);
  json["settings"] = record.settings_yaml;
  json["voxel_m"] = record.voxel_m;
  json["counts"] = counts_json(count(record));
  json["components"] = components_json(record);
  json["edits"] = edits_json(record);
  if (!record.solution.control.empty()) json["control"] = control_json(record);
  json["warnings"] = warnings_json(record);
  json["run"] = run_section(record.run);
  return text_of(json);
}

}  // namespace isthmus::report
