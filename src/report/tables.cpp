#include "report/tables.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "report/csv.h"

namespace isthmus::report {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (const std::string& part : parts) out += (out.empty() ? "" : "; ") + part;
  return out;
}

int accepted_links(const SurveyRecord& record, int id) {
  return static_cast<int>(
      std::count_if(record.solution.links.begin(), record.solution.links.end(), [&](const SolvedLink& l) {
        return l.link.result.verdict == Verdict::accepted && (l.link.source == id || l.link.target == id);
      }));
}

/// Names in the order in which they first appear: evidence terms come in a fixed order per link, but a link may have
/// fewer.
template <class Terms>
std::vector<std::string> names_of(const SurveyRecord& record, Terms terms) {
  std::vector<std::string> names;
  for (const SolvedLink& l : record.solution.links)
    for (const auto& [name, value] : terms(l.link.result))
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

void add_terms(CsvTable& csv, const std::vector<std::string>& names,
               const std::vector<std::pair<std::string, double>>& terms) {
  for (const std::string& name : names) {
    const auto term = std::find_if(terms.begin(), terms.end(), [&](const auto& t) { return t.first == name; });
    if (term == terms.end())
      csv.skip();
    else
      csv.add(term->second);
  }
}

void add_transform(CsvTable& csv, const std::optional<Transform>& t) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      if (t)
        csv.add_exact((*t)(row, column));
      else
        csv.skip();
    }
}

void add_error(CsvTable& csv, const std::optional<LinkError>& error) {
  if (error)
    csv.add(error->rotation_rad * kDegPerRad).add(error->translation_m);
  else
    csv.skip().skip();
}

const auto& evidence_of(const PairResult& r) { return r.evidence; }
const auto& counts_of(const PairResult& r) { return r.counts; }

}  // namespace

std::string scans_csv(const SurveyRecord& record) {
  CsvTable csv;
  for (const char* name : {"id",      "name",           "status",  "component",      "points",         "reason",
                           "anchor",  "accepted_links", "sigma_m", "sigma_deg",      "points_read",    "points_dropped",
                           "voxel_m", "spacing_m",      "station", "local_origin_x", "local_origin_y", "local_origin_z",
                           "format",  "notes"})
    csv.add(name);
  csv.end_row();
  for (const ScanRecord& scan : record.scans) {
    const PlacedScan* placed = record.solution.find(scan.id);
    csv.add(scan.id).add(scan.name).add(word(scan.status));
    if (placed != nullptr)
      csv.add(placed->component);
    else
      csv.skip();
    csv.add(static_cast<long long>(scan.points)).add(scan.reason);
    csv.add(placed != nullptr && record.solution.components[placed->component].anchor == scan.id ? 1 : 0);
    csv.add(accepted_links(record, scan.id));
    if (placed != nullptr && placed->sigma_m)
      csv.add(*placed->sigma_m).add(placed->sigma_rad.value_or(0) * kDegPerRad);
    else
      csv.skip().skip();
    csv.add(static_cast<long long>(scan.num_read)).add(static_cast<long long>(scan.num_dropped));
    csv.add(scan.voxel_m).add(scan.spacing_m).add(word(scan.station_kind));
    for (int k = 0; k < 3; ++k) csv.add_exact(scan.local_origin_in_scan[k]);
    csv.add(scan.format).add(joined(scan.notes)).end_row();
  }
  return csv.text();
}

std::string links_csv(const SurveyRecord& record) {
  const std::vector<std::string> evidence = names_of(record, evidence_of), counts = names_of(record, counts_of);
  CsvTable csv;
  for (const char* name : {"source",
                           "target",
                           "verdict",
                           "reason",
                           "probability",
                           "overlap",
                           "rms_m",
                           "source_name",
                           "target_name",
                           "verdict_of_pair",
                           "guided",
                           "in_loop",
                           "probability_with_loops",
                           "error_deg",
                           "error_m",
                           "error_before_deg",
                           "error_before_m",
                           "by_hand",
                           "first_round",
                           "second_round",
                           "overlap_of_source",
                           "overlap_of_target",
                           "r00",
                           "r01",
                           "r02",
                           "tx",
                           "r10",
                           "r11",
                           "r12",
                           "ty",
                           "r20",
                           "r21",
                           "r22",
                           "tz"})
    csv.add(name);
  for (const std::string& name : evidence) csv.add(name);
  for (const std::string& name : counts) csv.add("num_" + name);
  csv.end_row();
  for (const SolvedLink& l : record.solution.links) {
    const PairResult& r = l.link.result;
    const ScanRecord* source = find_scan(record, l.link.source);
    const ScanRecord* target = find_scan(record, l.link.target);
    csv.add(l.link.source).add(l.link.target).add(word(r.verdict)).add(r.reason).add(r.probability);
    const bool measured = r.target_from_source && l.link.by_hand != ByHand::added;
    if (measured)
      csv.add(r.overlap).add(r.rms_m);
    else
      csv.skip().skip();
    csv.add(source != nullptr ? source->name : "").add(target != nullptr ? target->name : "");
    csv.add(word(l.measured)).add(l.link.guided ? 1 : 0).add(l.in_loop ? 1 : 0).add(l.probability);
    add_error(csv, l.after);
    add_error(csv, l.before);
    csv.add(word(l.link.by_hand)).add(l.link.first_round ? 1 : 0).add(l.link.second_round ? 1 : 0);
    if (measured)
      csv.add(r.overlap_of_source).add(r.overlap_of_target);
    else
      csv.skip().skip();
    const bool known = r.target_from_source && source != nullptr && target != nullptr;
    add_transform(csv, known ? std::optional(target_from_source_in_scans(record, l.link)) : std::nullopt);
    add_terms(csv, evidence, r.evidence);
    add_terms(csv, counts, r.counts);
    csv.end_row();
  }
  return csv.text();
}

std::string covariances_csv(const SurveyRecord& record) {
  CsvTable csv;
  for (const char* name : {"id", "name", "component", "centre_x", "centre_y", "centre_z"}) csv.add(name);
  constexpr std::array<const char*, 6> kAxes = {"x", "y", "z", "rx", "ry", "rz"};
  for (std::size_t row = 0; row < kAxes.size(); ++row)
    for (std::size_t column = row; column < kAxes.size(); ++column)
      csv.add(fmt::format("c_{}_{}", kAxes[row], kAxes[column]));
  csv.end_row();
  for (const ScanRecord& scan : record.scans) {
    const PlacedScan* placed = record.solution.find(scan.id);
    if (placed == nullptr || !placed->covariance) continue;
    const Eigen::Vector3d centre = component_from_scan(record, scan.id) * (scan.centre + scan.local_origin_in_scan);
    csv.add(scan.id).add(scan.name).add(placed->component);
    for (int k = 0; k < 3; ++k) csv.add_exact(centre[k]);
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) csv.add((*placed->covariance)(row, column));
    csv.end_row();
  }
  return csv.text();
}

std::string timings_csv(const SurveyRecord& record) {
  CsvTable csv;
  for (const char* name : {"item", "source", "target", "stage", "seconds"}) csv.add(name);
  csv.end_row();
  for (const ScanRecord& scan : record.scans)
    for (const auto& [stage, seconds] : scan.seconds)
      csv.add("scan").add(scan.id).skip().add(stage).add(seconds).end_row();
  for (const SolvedLink& l : record.solution.links)
    for (const auto& [stage, seconds] : l.link.result.seconds_by_stage)
      csv.add("pair").add(l.link.source).add(l.link.target).add(stage).add(seconds).end_row();
  return csv.text();
}

}  // namespace isthmus::report
