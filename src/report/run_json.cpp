#include "report/run_json.h"

#include <nlohmann/json.hpp>

namespace isthmus::report {
namespace {

using Json = nlohmann::ordered_json;

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

Json components_json(const SurveyRecord& record) {
  Json out = Json::array();
  for (const Component& component : record.solution.components) {
    Json names = Json::array();
    for (const int id : component.scans) names.push_back(find_scan(record, id)->name);
    out.push_back({{"anchor", find_scan(record, component.anchor)->name}, {"scans", std::move(names)}});
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
  for (const auto& [name, version] : record.versions) json["versions"][name] = version;
  json["settings"] = record.settings_yaml;
  json["voxel_m"] = record.voxel_m;
  json["counts"] = counts_json(count(record));
  json["components"] = components_json(record);
  Json warnings = record.warnings;
  for (const std::string& warning : record.solution.warnings) warnings.push_back(warning);
  json["warnings"] = std::move(warnings);
  json["run"] = run_section(record.run);
  // Replacing broken UTF-8 (file names may hold any byte) keeps the file readable instead of throwing.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace isthmus::report
