#include "pipelines/guided_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus::pipelines {
namespace {

constexpr float kReachCells = 1.5F;  // as overlaps are measured everywhere: within 1.5 cells

/// Share of the source's outline that has an outline point of the target nearby.
double covered(const ScanSummary& source, const ScanSummary& target, float reach_m,
               const Transform& target_from_source) {
  const Eigen::Isometry3f t = target_from_source.cast<float>();
  Eigen::AlignedBox3f near;  // most points of most pairs are far from all of the target's
  for (const Eigen::Vector3f& p : target.outline) near.extend(p);
  near.extend(near.min() - Eigen::Vector3f::Constant(reach_m)),
      near.extend(near.max() + Eigen::Vector3f::Constant(reach_m));
  std::vector<Eigen::Vector3f> candidates;
  for (const Eigen::Vector3f& p : source.outline)
    if (const Eigen::Vector3f moved = t * p; near.contains(moved)) candidates.push_back(moved);
  if (candidates.empty()) return 0;
  const PointGrid grid(target.outline, reach_m);
  std::size_t hits = 0;
  for (const Eigen::Vector3f& p : candidates) hits += grid.nearest_within(p, reach_m).first >= 0 ? 1 : 0;
  return static_cast<double>(hits) / static_cast<double>(std::max<std::size_t>(1, source.outline.size()));
}

float extent_of(const ScanSummary& scan) {
  float sq_extent = 0;
  for (const Eigen::Vector3f& p : scan.outline)
    sq_extent = std::max(sq_extent, (p - scan.centre.cast<float>()).squaredNorm());
  return std::sqrt(sq_extent);
}

/// The best few of each scan; a pair stays if either of its scans wants it.
std::vector<GuidedPair> best_of_each(std::vector<GuidedPair> pairs, int pairs_per_scan) {
  std::ranges::stable_sort(pairs, std::ranges::greater(), &GuidedPair::predicted_overlap);
  std::map<int, int> wanted;
  std::erase_if(pairs, [&](const GuidedPair& pair) {
    const bool by_source = wanted[pair.source]++ < pairs_per_scan;
    const bool by_target = wanted[pair.target]++ < pairs_per_scan;
    return !by_source && !by_target;
  });
  std::ranges::sort(pairs, {}, [](const GuidedPair& p) { return std::pair(p.source, p.target); });
  return pairs;
}

}  // namespace

double predicted_overlap(const ScanSummary& source, const ScanSummary& target, const Transform& target_from_source) {
  const double apart = (target_from_source * source.centre - target.centre).norm();
  if (apart > extent_of(source) + extent_of(target)) return 0;
  const float reach = kReachCells * std::max(source.outline_cell_m, target.outline_cell_m);
  const double of_source = covered(source, target, reach, target_from_source);
  if (of_source < kLeastPredictedOverlap) return of_source;
  return std::min(of_source, covered(target, source, reach, target_from_source.inverse()));
}

std::vector<GuidedPair> propose_guided_pairs(const Solution& solution, std::span<const OutlinedScan> scans,
                                             int pairs_per_scan) {
  std::set<std::pair<int, int>> accepted;
  for (const SolvedLink& solved : solution.links) {
    if (solved.link.result.verdict == Verdict::accepted)
      accepted.emplace(std::minmax(solved.link.source, solved.link.target));
  }
  std::vector<std::vector<GuidedPair>> of_target(scans.size());
  parallel_for_index(scans.size(), 1, [&](std::size_t i) {
    const ScanSummary& target = *scans[i].summary;
    for (std::size_t j = i + 1; j < scans.size(); ++j) {
      const ScanSummary& source = *scans[j].summary;
      if (accepted.contains(std::minmax(scans[i].id, scans[j].id))) continue;
      const auto predicted = predicted_target_from_source(solution, scans[j].id, scans[i].id);
      if (!predicted) continue;
      const double overlap = predicted_overlap(source, target, *predicted);
      if (overlap >= kLeastPredictedOverlap) of_target[i].push_back({scans[j].id, scans[i].id, overlap, *predicted});
    }
  });
  std::vector<GuidedPair> all;
  for (const auto& pairs : of_target) all.insert(all.end(), pairs.begin(), pairs.end());
  return best_of_each(std::move(all), pairs_per_scan);
}

}  // namespace isthmus::pipelines
