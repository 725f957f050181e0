#include "report/loop_closures.h"

#include <algorithm>

namespace isthmus::report {
namespace {

bool is_same(const Link& a, const Link& b) { return a.source == b.source && a.target == b.target; }

}  // namespace

LoopClosures::LoopClosures(const SurveyRecord& record) : record_(record), edges_(record.scans.size()) {
  for (const SolvedLink& l : record.solution.links) {
    const int source = index_of(l.link.source), target = index_of(l.link.target);
    if (l.link.result.verdict != Verdict::accepted || !l.link.result.target_from_source) continue;
    if (source < 0 || target < 0) continue;
    edges_[source].push_back({target, &l.link});
    edges_[target].push_back({source, &l.link});
  }
  for (std::vector<Edge>& edges : edges_) std::ranges::stable_sort(edges, {}, [](const Edge& edge) { return edge.to; });
}

int LoopClosures::index_of(int id) const {
  const ScanRecord* scan = find_scan(record_, id);
  return scan == nullptr ? -1 : static_cast<int>(scan - record_.scans.data());
}

// Breadth first.
std::vector<const Link*> LoopClosures::shortest_path(int from, int to, const Link& without) const {
  std::vector<Edge> came_by(edges_.size());  // `to` is where the edge came from here
  std::vector<int> queue = {from};
  std::vector<char> seen(edges_.size(), 0);
  seen[from] = 1;
  for (std::size_t k = 0; k < queue.size() && !seen[to]; ++k) {
    for (const Edge& edge : edges_[queue[k]]) {
      if (seen[edge.to] || is_same(*edge.by, without)) continue;
      seen[edge.to] = 1;
      came_by[edge.to] = {queue[k], edge.by};
      queue.push_back(edge.to);
    }
  }
  std::vector<const Link*> path;
  if (!seen[to]) return path;
  for (int at = to; at != from; at = came_by[at].to) path.push_back(came_by[at].by);
  std::ranges::reverse(path);
  return path;
}

std::optional<LoopClosure> LoopClosures::of(const Link& link) const {
  const int source = index_of(link.source), target = index_of(link.target);
  if (!link.result.target_from_source || source < 0 || target < 0) return std::nullopt;
  const std::vector<const Link*> path = shortest_path(source, target, link);
  if (path.empty()) return std::nullopt;
  LoopClosure closure;
  Transform here_from_source = Transform::Identity();
  int here = link.source;
  for (const Link* step : path) {
    const bool forward = step->source == here;
    const Transform& t = *step->result.target_from_source;
    here_from_source = (forward ? t : t.inverse()) * here_from_source;
    here = forward ? step->target : step->source;
    if (here != link.target) closure.via.push_back(here);
  }
  const Transform& measured = *link.result.target_from_source;
  const Eigen::Vector3d& centre = record_.scans[source].centre;
  closure.translation_m = (measured * centre - here_from_source * centre).norm();
  closure.rotation_rad = rotation_angle_rad(measured.linear().transpose() * here_from_source.linear());
  return closure;
}

}  // namespace isthmus::report
