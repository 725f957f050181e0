#include "congruent/trial.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <set>

#include "congruent/congruent_sets.h"
#include "congruent/fit.h"

namespace isthmus::congruent {
namespace {

constexpr std::size_t kFirstLookPoints = 64;  // tells a share to 6 %: enough to leave out what is far off
constexpr int kBasesDrawn = 4;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

double normal_tolerance_rad(const TrialSetting& s) { return s.options.normal_tolerance_deg * kRadiansPerDegree; }

CosineInterval same_angle(const Eigen::Vector3f& u, const Eigen::Vector3f& v, double tolerance_rad) {
  return cosines_near(static_cast<double>(u.dot(v)), tolerance_rad);
}

// What the likenesses of the diagonal from p to q look like.
PairQuery query_for(const TrialSetting& s, std::uint32_t p, std::uint32_t q) {
  const Eigen::Vector3f forth = s.source.points[q] - s.source.points[p];
  const float length = forth.norm(), tolerance = static_cast<float>(s.tolerance_m);
  PairQuery query{.min_distance_m = std::max(0.0F, length - tolerance), .max_distance_m = length + tolerance};
  if (!s.source.normals.empty()) {
    const Eigen::Vector3f direction = forth / length;
    // Both ends may be off by a tolerance, which turns the direction on top of the normal's own noise.
    const double angle = normal_tolerance_rad(s), turned = angle + s.tolerance_m / static_cast<double>(length);
    query.between_normals = same_angle(s.source.normals[p], s.source.normals[q], angle);
    query.first_normal = same_angle(s.source.normals[p], direction, turned);
    query.second_normal = same_angle(s.source.normals[q], direction, turned);
  }
  if (s.search.gravity) {
    const float rise = s.search.gravity->up_in_source.cast<float>().dot(forth);
    const float slack =
        tolerance +
        length * static_cast<float>(std::sin(std::min(s.search.gravity->tolerance_rad, std::numbers::pi / 2)));
    query.up = s.search.gravity->up_in_target.cast<float>();
    query.min_rise_m = rise - slack, query.max_rise_m = rise + slack;
  }
  return query;
}

// How many of the source's own pairs look like the two diagonals: what is common here will be common in the target.
std::size_t commonness(const TrialSetting& s, const Base& base) {
  const auto& [a, b, c, d] = base.points;
  std::size_t product = 1;
  for (const PairQuery& query : {query_for(s, a, b), query_for(s, c, d)}) {
    const auto count = std::count_if(s.source_pairs.begin(), s.source_pairs.end(), [&](PointPair pair) {
      return answers(query, s.source.points, s.source.normals, pair);
    });
    product *= static_cast<std::size_t>(count) + 1;
  }
  return product;
}

// The least common of a few bases drawn. Judged in the source alone: in the target, what lies outside the overlap would
// look rarest.
std::optional<Base> draw_base(const TrialSetting& s, Rng& rng) {
  std::optional<Base> rarest;
  std::size_t least = 0;
  for (int i = 0; i < kBasesDrawn; ++i) {
    const auto base = select_base(s.source, s.wish, rng);
    if (!base) continue;
    const std::size_t common = commonness(s, *base);
    if (!rarest || common < least) rarest = base, least = common;
  }
  return rarest;
}

// Which target points may stand for one source point, by prior and gravity.
class StandIn {
 public:
  StandIn(const TrialSetting& s, std::uint32_t p) : oriented_(!s.source.normals.empty()) {
    const Eigen::Vector3d point = s.source.points[p].cast<double>();
    if (s.search.prior) {
      const CongruentPrior& prior = *s.search.prior;
      const double half_turn_rad = std::min(0.5 * prior.max_rotation_rad, 0.5 * std::numbers::pi);
      const double radius_m = prior.max_translation_m + 2 * std::sin(half_turn_rad) * point.norm() + s.tolerance_m;
      place_ = (prior.target_from_source * point).cast<float>();
      sq_radius_ = static_cast<float>(radius_m * radius_m);
    }
    if (!oriented_) return;
    const Eigen::Vector3d normal = s.source.normals[p].cast<double>();
    const double angle = normal_tolerance_rad(s);
    if (s.search.prior) {
      normal_ = (s.search.prior->target_from_source.linear() * normal).cast<float>();
      facing_ = cosines_near(1, angle + s.search.prior->max_rotation_rad);
    }
    if (s.search.gravity) {
      up_ = s.search.gravity->up_in_target.cast<float>();
      slope_ = cosines_near(s.search.gravity->up_in_source.dot(normal), angle + s.search.gravity->tolerance_rad);
    }
  }
  [[nodiscard]] bool accepts(const LocalCloud& target, std::size_t i) const {
    if ((target.points[i] - place_).squaredNorm() > sq_radius_) return false;
    return !oriented_ ||
           (facing_.contains(normal_.dot(target.normals[i])) && slope_.contains(up_.dot(target.normals[i])));
  }

 private:
  bool oriented_;
  Eigen::Vector3f place_ = Eigen::Vector3f::Zero();
  float sq_radius_ = std::numeric_limits<float>::max();
  Eigen::Vector3f normal_ = Eigen::Vector3f::Zero(), up_ = Eigen::Vector3f::Zero();
  CosineInterval facing_, slope_;  // open until the constructor narrows them
};

// Empty when nothing is known beforehand: then every point may stand for everything.
std::vector<std::uint8_t> roles_for(const TrialSetting& s, std::uint32_t p, std::uint32_t q) {
  if (!s.search.prior && !s.search.gravity) return {};
  const StandIn first(s, p), second(s, q);
  std::vector<std::uint8_t> roles(s.target.points.size(), kNoRole);
  for (std::size_t i = 0; i < roles.size(); ++i)
    roles[i] = static_cast<std::uint8_t>((first.accepts(s.target, i) ? kFirstRole : kNoRole) |
                                         (second.accepts(s.target, i) ? kSecondRole : kNoRole));
  return roles;
}

SetQuery query_for(const TrialSetting& s, const Base& base) {
  SetQuery query{.r1 = base.r1, .r2 = base.r2, .max_gap_m = base.gap_m + s.tolerance_m};
  query.angle = cosines_near(base.cos_angle, s.tolerance_m / base.length1_m + s.tolerance_m / base.length2_m);
  if (s.source.normals.empty()) return query;
  for (const std::size_t k : {0U, 1U, 2U, 3U})
    query.between_normals[k] = same_angle(s.source.normals[base.points[k / 2]],
                                          s.source.normals[base.points[2 + k % 2]], normal_tolerance_rad(s));
  return query;
}

// Nothing when a pair list or the sets overflow their caps; then counts.trials_too_common says so.
std::vector<CongruentSet> sets_for(const TrialSetting& s, const Base& base, CongruentCounts& counts) {
  const auto max_pairs = static_cast<std::size_t>(s.options.max_pairs);
  PairCounts pair_counts;
  SetCounts set_counts;
  const auto pairs_of = [&](std::uint32_t p, std::uint32_t q) {
    return s.pairs.find(query_for(s, p, q), roles_for(s, p, q), max_pairs, pair_counts);
  };
  std::optional<std::vector<CongruentSet>> sets;
  const auto& [a, b, c, d] = base.points;
  const auto ab = pairs_of(a, b);
  if (ab && ab->empty()) {
    sets.emplace();
  } else if (ab) {
    if (const auto cd = pairs_of(c, d)) {
      counts.pairs += ab->size() + cd->size();
      sets = find_congruent_sets(query_for(s, base), s.target.points, s.target.normals, *ab, *cd,
                                 static_cast<std::size_t>(s.options.max_congruent_sets), set_counts);
    }
  }
  counts.cell_tests += pair_counts.cell_tests;
  counts.distance_tests += pair_counts.distance_tests;
  counts.gap_tests += set_counts.gap_tests;
  if (!sets) {
    ++counts.trials_too_common;
    return {};
  }
  counts.congruent_sets += sets->size();
  return *sets;
}

std::array<Eigen::Vector3d, 4> corners(const LocalCloud& cloud, const std::array<std::uint32_t, 4>& points) {
  std::array<Eigen::Vector3d, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = cloud.points[points[k]].cast<double>();
  return out;
}

// True if the corners face the same way under the pose and the prior allows it.
bool plausible(const TrialSetting& s, const Base& base, const CongruentSet& set, const Transform& pose) {
  const double min_cosine = std::cos(s.options.facing_tolerance_deg * kRadiansPerDegree);
  for (std::size_t k = 0; k < 4 && !s.source.normals.empty(); ++k) {
    const Eigen::Vector3d turned = pose.linear() * s.source.normals[base.points[k]].cast<double>();
    if (turned.dot(s.target.normals[set[k]].cast<double>()) < min_cosine) return false;
  }
  const double slack_rad = 2 * s.tolerance_m / std::min(base.length1_m, base.length2_m);
  return !s.search.prior || within(*s.search.prior, pose, slack_rad, s.tolerance_m);
}

// Poses that carry three far points of the source into the same cells count once: each corner of a right base has
// several target points within the tolerance, so right poses come in crowds.
class Crowds {
 public:
  explicit Crowds(const TrialSetting& s) : reach_m_(0.5 * s.source.diameter_m), inverse_edge_(1 / s.tolerance_m) {}
  /// True for the first pose of its crowd.
  bool is_new(const Transform& pose) {
    std::array<std::int64_t, 9> cells{};
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d p = pose.translation() + (k == 0 ? 0.0 : reach_m_) * pose.linear().col(k);
      for (int axis = 0; axis < 3; ++axis)
        cells[static_cast<std::size_t>(3 * k + axis)] = static_cast<std::int64_t>(std::floor(p[axis] * inverse_edge_));
    }
    return seen_.insert(cells).second;
  }

 private:
  double reach_m_, inverse_edge_;
  std::set<std::array<std::int64_t, 9>> seen_;
};

struct FirstLook {
  Transform pose;
  std::int64_t common = 0;
};

// The poses of all sets, most promising first and no more than are to be scored in full.
std::vector<FirstLook> most_promising(const TrialSetting& s, const Base& base, const std::vector<CongruentSet>& sets,
                                      CongruentCounts& counts, ScoreCounts& score_counts) {
  const auto capacity = static_cast<std::size_t>(s.options.max_scored);
  Crowds crowds(s);
  const auto source_corners = corners(s.source, base.points);
  const DiagonalFit quick_fit(source_corners);
  std::priority_queue<std::int64_t, std::vector<std::int64_t>, std::greater<>> best_counts;
  std::vector<FirstLook> looks;
  for (const CongruentSet& set : sets) {
    const auto target_corners = corners(s.target, set);
    if (!crowds.is_new(quick_fit(target_corners))) continue;
    const auto fit = fit_rigid(source_corners, target_corners);
    if (!fit || fit->rms_m > s.tolerance_m || !plausible(s, base, set, fit->target_from_source)) continue;
    ++counts.transforms_looked_at;
    const std::int64_t to_beat = best_counts.size() < capacity ? -1 : best_counts.top();
    const auto common =
        count_leading(s.grid, s.sample, kFirstLookPoints, fit->target_from_source, to_beat, score_counts);
    if (!common) continue;
    looks.push_back({fit->target_from_source, *common});
    best_counts.push(*common);
    if (best_counts.size() > capacity) best_counts.pop();
  }
  std::stable_sort(looks.begin(), looks.end(), [](const auto& a, const auto& b) { return a.common > b.common; });
  if (looks.size() > capacity) looks.resize(capacity);
  return looks;
}

}  // namespace

bool within(const CongruentPrior& prior, const Transform& target_from_source, double slack_rad, double slack_m) {
  const double moved_m = (target_from_source.translation() - prior.target_from_source.translation()).norm();
  if (moved_m > prior.max_translation_m + slack_m) return false;
  const Eigen::Matrix3d turn = target_from_source.linear() * prior.target_from_source.linear().transpose();
  return rotation_angle_rad(turn) <= prior.max_rotation_rad + slack_rad;
}

TrialOutcome run_trial(const TrialSetting& s, int trial, Rng rng, std::int64_t to_beat) {
  TrialOutcome outcome{BestTransforms(s.num_kept, s.distinct_m, 0.5 * s.source.diameter_m, to_beat), {}};
  const auto base = draw_base(s, rng);
  if (!base) {
    ++outcome.counts.trials_without_base;
    return outcome;
  }
  ScoreCounts score_counts;
  const auto sets = sets_for(s, *base, outcome.counts);
  for (const FirstLook& look : most_promising(s, *base, sets, outcome.counts, score_counts)) {
    ++outcome.counts.transforms_scored;
    const auto common = count_common(s.grid, s.sample, look.pose, outcome.best.to_beat(), score_counts);
    if (common) outcome.best.add({look.pose, *common, trial, {trial}});
  }
  outcome.counts.points_looked_up = score_counts.points_looked_up;
  return outcome;
}

}  // namespace isthmus::congruent
