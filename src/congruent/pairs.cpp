#include "congruent/pairs.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace isthmus::congruent {
namespace {

constexpr std::uint32_t kLeafPoints = 6;  // splitting further costs more cell tests than it saves distance tests
constexpr int kMaxDepth = 20;             // coincident points never separate
constexpr float kSlack = 1e-5F;           // relative; box distances are rounded, so cells are pruned with this to spare

float sq_distance_to_nearest(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const Eigen::Vector3f& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0F).squaredNorm();
}

float sq_distance_to_farthest(const Eigen::Vector3f& low, const Eigen::Vector3f& high, const Eigen::Vector3f& p) {
  return (p - low).cwiseMax(high - p).squaredNorm();
}

bool in_shell(const PairQuery& query, float sq_distance) {
  return sq_distance >= query.min_distance_m * query.min_distance_m &&
         sq_distance <= query.max_distance_m * query.max_distance_m;
}

// Everything but the distance, for the ordered pair; `forth` points from first to second.
bool directions_answer(const PairQuery& query, const Eigen::Vector3f& forth, float distance,
                       const Eigen::Vector3f* first_normal, const Eigen::Vector3f* second_normal) {
  if (!query.up.isZero()) {
    const float rise = query.up.dot(forth);
    if (rise < query.min_rise_m || rise > query.max_rise_m) return false;
  }
  if (first_normal == nullptr || distance <= 0) return true;
  return query.between_normals.contains(first_normal->dot(*second_normal)) &&
         query.first_normal.contains(first_normal->dot(forth) / distance) &&
         query.second_normal.contains(second_normal->dot(forth) / distance);
}

}  // namespace

bool answers(const PairQuery& query, std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
             PointPair pair) {
  const Eigen::Vector3f forth = points[pair.second] - points[pair.first];
  const float sq_distance = forth.squaredNorm();
  if (!in_shell(query, sq_distance)) return false;
  const bool oriented = !normals.empty();
  return directions_answer(query, forth, std::sqrt(sq_distance), oriented ? &normals[pair.first] : nullptr,
                           oriented ? &normals[pair.second] : nullptr);
}

PairIndex::PairIndex(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals)
    : order_(points.size()), points_(points.begin(), points.end()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (points.empty()) return;
  nodes_.push_back({.begin = 0, .end = static_cast<std::uint32_t>(points.size())});
  split(0, 0);
  for (std::size_t i = 0; i < order_.size(); ++i) points_[i] = points[order_[i]];
  for (std::size_t i = 0; i < normals.size(); ++i) normals_.push_back(normals[order_[i]]);
}

// While the tree is built points_ is still in input order and order_ is what gets sorted.
void PairIndex::split(std::uint32_t index, int depth) {
  const std::uint32_t begin = nodes_[index].begin, end = nodes_[index].end;
  Eigen::Vector3f low = points_[order_[begin]], high = low;
  for (std::uint32_t i = begin; i < end; ++i) {
    low = low.cwiseMin(points_[order_[i]]);
    high = high.cwiseMax(points_[order_[i]]);
  }
  nodes_[index].low = low, nodes_[index].high = high;
  if (end - begin <= kLeafPoints || depth == kMaxDepth || low == high) return;

  const Eigen::Vector3f middle = 0.5F * (low + high);
  const auto octant = [&](std::uint32_t i) {
    const Eigen::Vector3f& p = points_[i];
    return (p.x() > middle.x() ? 1U : 0U) | (p.y() > middle.y() ? 2U : 0U) | (p.z() > middle.z() ? 4U : 0U);
  };
  std::stable_sort(order_.begin() + begin, order_.begin() + end,
                   [&](std::uint32_t i, std::uint32_t j) { return octant(i) < octant(j); });
  const auto first_child = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t i = begin; i < end;) {
    std::uint32_t stop = i + 1;
    while (stop < end && octant(order_[stop]) == octant(order_[i])) ++stop;
    nodes_.push_back({.begin = i, .end = stop});
    i = stop;
  }
  const auto num_children = static_cast<std::uint32_t>(nodes_.size()) - first_child;
  nodes_[index].child = first_child, nodes_[index].num_children = num_children;
  for (std::uint32_t c = 0; c < num_children; ++c) split(first_child + c, depth + 1);
}

// One descent of all spheres. Points are numbered by their place in the tree; a sphere around i looks for j > i only.
struct PairIndex::Search {
  const PairIndex& index;
  const PairQuery& query;
  std::size_t max_pairs;
  PairCounts& counts;
  std::vector<std::uint8_t> roles{};                                // by place in the tree
  std::vector<std::uint8_t> node_roles{};                           // what any point of a node may stand for
  std::array<std::vector<std::uint32_t>, kMaxDepth + 1> spheres{};  // per depth: the spheres that cross the cell
  std::vector<PointPair> found{};
  bool full = false;

  void prepare(std::span<const std::uint8_t> roles_by_point);
  void enter(const Node& parent, int depth);
  void hand_down(const Node& node, std::uint8_t node_role, int depth);
  void test_leaf(const Node& node, int depth);
  void test(std::uint32_t i, std::uint32_t j);
  void keep_if_answers(std::uint32_t i, std::uint32_t j, const Eigen::Vector3f& forth, float distance);
  static bool can_pair(std::uint8_t a, std::uint8_t b) {
    return ((a & kFirstRole) != 0 && (b & kSecondRole) != 0) || ((a & kSecondRole) != 0 && (b & kFirstRole) != 0);
  }
};

void PairIndex::Search::prepare(std::span<const std::uint8_t> roles_by_point) {
  roles.assign(index.order_.size(), kBothRoles);
  node_roles.assign(index.nodes_.size(), kBothRoles);
  if (roles_by_point.empty()) return;
  for (std::size_t i = 0; i < roles.size(); ++i) roles[i] = roles_by_point[index.order_[i]];
  for (std::size_t n = index.nodes_.size(); n-- > 0;) {  // children come after their parent
    const Node& node = index.nodes_[n];
    std::uint8_t any = kNoRole;
    for (std::uint32_t c = 0; c < node.num_children; ++c) any |= node_roles[node.child + c];
    if (node.num_children == 0)
      for (std::uint32_t i = node.begin; i < node.end; ++i) any |= roles[i];
    node_roles[n] = any;
  }
}

void PairIndex::Search::hand_down(const Node& node, std::uint8_t node_role, int depth) {
  const float inner = query.min_distance_m * query.min_distance_m * (1 - kSlack);
  const float outer = query.max_distance_m * query.max_distance_m * (1 + kSlack);
  auto& kept = spheres[static_cast<std::size_t>(depth) + 1];
  kept.clear();
  for (const std::uint32_t i : spheres[static_cast<std::size_t>(depth)]) {
    if (i + 1 >= node.end) break;  // ascending: no later sphere has a partner here either
    if (!can_pair(roles[i], node_role)) continue;
    ++counts.cell_tests;
    const Eigen::Vector3f& centre = index.points_[i];
    if (sq_distance_to_nearest(node.low, node.high, centre) <= outer &&
        sq_distance_to_farthest(node.low, node.high, centre) >= inner)
      kept.push_back(i);
  }
}

void PairIndex::Search::enter(const Node& parent, int depth) {
  for (std::uint32_t c = 0; c < parent.num_children && !full; ++c) {
    const Node& node = index.nodes_[parent.child + c];
    hand_down(node, node_roles[parent.child + c], depth);
    if (spheres[static_cast<std::size_t>(depth) + 1].empty()) continue;
    if (node.num_children == 0) {
      test_leaf(node, depth + 1);
    } else {
      enter(node, depth + 1);
    }
  }
}

void PairIndex::Search::test_leaf(const Node& node, int depth) {
  for (const std::uint32_t i : spheres[static_cast<std::size_t>(depth)])
    for (std::uint32_t j = std::max(node.begin, i + 1); j < node.end; ++j)
      if (can_pair(roles[i], roles[j])) test(i, j);
}

void PairIndex::Search::test(std::uint32_t i, std::uint32_t j) {
  ++counts.distance_tests;
  const Eigen::Vector3f forth = index.points_[j] - index.points_[i];
  const float sq_distance = forth.squaredNorm();
  if (!in_shell(query, sq_distance)) return;
  const float distance = std::sqrt(sq_distance);
  keep_if_answers(i, j, forth, distance);
  keep_if_answers(j, i, -forth, distance);
}

void PairIndex::Search::keep_if_answers(std::uint32_t i, std::uint32_t j, const Eigen::Vector3f& forth,
                                        float distance) {
  if ((roles[i] & kFirstRole) == 0 || (roles[j] & kSecondRole) == 0) return;
  const bool oriented = !index.normals_.empty();
  if (!directions_answer(query, forth, distance, oriented ? &index.normals_[i] : nullptr,
                         oriented ? &index.normals_[j] : nullptr))
    return;
  if (found.size() == max_pairs) {
    full = true;
  } else {
    found.push_back({index.order_[i], index.order_[j]});
  }
}

std::optional<std::vector<PointPair>> PairIndex::find(const PairQuery& query, std::span<const std::uint8_t> roles,
                                                      std::size_t max_pairs, PairCounts& counts) const {
  if (points_.size() < 2) return std::vector<PointPair>{};
  Search search{.index = *this, .query = query, .max_pairs = max_pairs, .counts = counts};
  search.prepare(roles);
  for (std::uint32_t i = 0; i < points_.size(); ++i)
    if (search.roles[i] != kNoRole) search.spheres[0].push_back(i);
  if (nodes_[0].num_children == 0) {
    search.test_leaf(nodes_[0], 0);
  } else {
    search.enter(nodes_[0], 0);
  }
  if (search.full) return std::nullopt;
  return std::move(search.found);
}

}  // namespace isthmus::congruent
