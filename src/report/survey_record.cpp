#include "report/survey_record.h"

#include <algorithm>

#include <fmt/format.h>

namespace isthmus::report {
namespace {

std::string unplaced_reason(const SurveyRecord& record, int id) {
  if (record.solution.scans.size() == 1) return "the only scan that was read";
  const SolvedLink* best = best_open_link(record, *component_of(record, id));
  if (best == nullptr) return "no pair with it was tried";
  const int other = best->link.source == id ? best->link.target : best->link.source;
  const ScanRecord* partner = find_scan(record, other);
  return fmt::format("no accepted link; nearest was {} with {} ({}, probability {:.2f})",
                     word(best->link.result.verdict), partner != nullptr ? partner->name : std::to_string(other),
                     best->link.result.reason, best->link.result.probability);
}

}  // namespace

const char* word(ScanStatus status) {
  switch (status) {
    case ScanStatus::placed:
      return "placed";
    case ScanStatus::unplaced:
      return "unplaced";
    case ScanStatus::failed:
      return "failed";
  }
  return "unknown";
}

const char* word(Verdict verdict) { return to_string(verdict); }

const char* word(StationKind kind) {
  switch (kind) {
    case StationKind::unknown:
      return "unknown";
    case StationKind::origin:
      return "origin";
    case StationKind::estimated:
      return "estimated";
  }
  return "unknown";
}

const char* word(ByHand by_hand) {
  switch (by_hand) {
    case ByHand::nothing:
      return "";
    case ByHand::taken_out:
      return "taken out";
    case ByHand::added:
      return "added";
  }
  return "unknown";
}

const ScanRecord* find_scan(const SurveyRecord& record, int id) {
  const auto at = std::lower_bound(record.scans.begin(), record.scans.end(), id,
                                   [](const ScanRecord& s, int key) { return s.id < key; });
  return at != record.scans.end() && at->id == id ? &*at : nullptr;
}

std::optional<int> component_of(const SurveyRecord& record, int id) {
  const PlacedScan* placed = record.solution.find(id);
  return placed == nullptr ? std::nullopt : std::optional<int>(placed->component);
}

std::optional<double> evidence_term(const PairResult& result, std::string_view name) {
  const auto at =
      std::ranges::find(result.evidence, name, [](const auto& term) { return std::string_view(term.first); });
  return at == result.evidence.end() ? std::nullopt : std::optional<double>(at->second);
}

const SolvedLink* best_open_link(const SurveyRecord& record, int component) {
  const SolvedLink* best = nullptr;
  for (const SolvedLink& l : record.solution.links) {
    const auto a = component_of(record, l.link.source), b = component_of(record, l.link.target);
    if (!a || !b || (*a == component) == (*b == component)) continue;
    const auto rank = [](const SolvedLink& s) { return std::pair(s.link.result.verdict, s.link.result.probability); };
    if (best == nullptr || rank(l) > rank(*best)) best = &l;
  }
  return best;
}

void judge_scans(SurveyRecord& record) {
  for (ScanRecord& scan : record.scans) {
    const std::optional<int> component = component_of(record, scan.id);
    if (!component) {
      scan.status = ScanStatus::failed;
    } else if (record.solution.components[*component].scans.size() >= 2) {
      scan.status = ScanStatus::placed;
      scan.reason.clear();
    } else {
      scan.status = ScanStatus::unplaced;
      scan.reason = unplaced_reason(record, scan.id);
    }
  }
}

/// A part that was only levelled stays where its anchor's coordinates put it.
static Eigen::Vector3d level_origin(const SurveyRecord& record, const Component& component) {
  if (!component.georeference->levelled_only) return Eigen::Vector3d::Zero();
  return find_scan(record, component.anchor)->local_origin_in_scan;
}

Transform component_from_scan(const SurveyRecord& record, int id) {
  const PlacedScan& placed = *record.solution.find(id);
  const Component& component = record.solution.components[placed.component];
  const int anchor_id = component.anchor;
  if (component.georeference) {
    const Georeference& world = *component.georeference;
    return Eigen::Translation3d(world.shift_m + level_origin(record, component)) * world.shifted_from_component *
           placed.component_from_local * Eigen::Translation3d(-find_scan(record, id)->local_origin_in_scan);
  }
  if (id == anchor_id) return Transform::Identity();
  return Eigen::Translation3d(find_scan(record, anchor_id)->local_origin_in_scan) * placed.component_from_local *
         Eigen::Translation3d(-find_scan(record, id)->local_origin_in_scan);
}

Transform target_from_source_in_scans(const SurveyRecord& record, const Link& link) {
  return Eigen::Translation3d(find_scan(record, link.target)->local_origin_in_scan) * *link.result.target_from_source *
         Eigen::Translation3d(-find_scan(record, link.source)->local_origin_in_scan);
}

Matrix6d information_in_scan(const Matrix6d& information, const Eigen::Vector3d& o) {
  Matrix6d local_from_scan = Matrix6d::Identity();  // Ad(-o) = [1, -[o]x; 0, 1]
  local_from_scan.topRightCorner<3, 3>() << 0, o.z(), -o.y(), -o.z(), 0, o.x(), o.y(), -o.x(), 0;
  const Matrix6d moved = local_from_scan.transpose() * information * local_from_scan;
  return 0.5 * (moved + moved.transpose());
}

}  // namespace isthmus::report
