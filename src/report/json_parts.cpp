#include "report/json_parts.h"

namespace isthmus::report {

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
