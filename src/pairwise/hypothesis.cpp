#include "pairwise/hypothesis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "regions/align.h"
#include "regions/lookups.h"

namespace isthmus {
namespace {

std::vector<std::uint32_t> even_sample(const ScanModel& model, std::size_t max_points) {
  const std::size_t n = model.points.size(), count = std::min(n, max_points);
  std::vector<std::uint32_t> sample(count);
  for (std::size_t k = 0; k < count; ++k) sample[k] = static_cast<std::uint32_t>(k * n / count);
  return sample;
}

// Tolerance along the normal in coarse voxels, the same in metres at both levels: flat surfaces meet within a fifth of
// a voxel (a curved wall sags that much between two points of it), rough ones within their roughness.
float tolerance_m(const ScanModel& model, std::int32_t point) {
  const float at_level = 1.2f * std::sqrt(model.variation[point]) * model.voxel_m;
  return 0.22f * static_cast<float>(model.scan.voxel_m) + at_level;
}

// widened_m: added to the tolerance, for poses that are known to be that far off.
Profile profile(const ScanModel& from, const ScanModel& to, const Transform& to_from,
                std::span<const std::uint32_t> sample, float widened_m = 0) {
  constexpr float kMinFacing = 0.5f, kFreeToleranceVoxels = 1.5f;
  const Pose3f pose = pose3f(to_from);
  Profile out;
  out.support.assign(sample.size(), 0.0f);
  std::size_t contradicted = 0, against = 0;
  for_each_lookup(from, to, to.fine, pose, sample, [&](std::size_t k, const Eigen::Vector3f& p, std::int32_t j) {
    if (j < 0) {
      contradicted += to.seen_through(p, kFreeToleranceVoxels * to.voxel_m);
      return;
    }
    const Eigen::Vector3f& n = to.normals[j];
    const float facing = n.dot(pose.rotation * from.normals[sample[k]]);
    if (facing < -kMinFacing) ++against;
    if (facing < kMinFacing) return;
    const float ratio = n.dot(p - to.points[j]) / (tolerance_m(to, j) + widened_m);
    if (!(ratio * ratio < 1)) return;
    out.support[k] = 1 - ratio * ratio;
    out.stiffness.noalias() += out.support[k] * n * n.transpose();
  });
  const double scale = sample.empty() ? 0.0 : 1.0 / static_cast<double>(sample.size());
  out.contradiction = static_cast<double>(contradicted) * scale;
  out.against = static_cast<double>(against) * scale;
  return out;
}

// `share`: of each profile, so that those of one basin sum to one.
std::vector<float> rarity(const std::vector<Hypothesis>& hypotheses, const Profile PoseProfiles::*direction,
                          const std::vector<float>& share, std::size_t n) {
  std::vector<float> weight(n, 0);
  float total = 0;
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    total += share[k];
    const std::vector<float>& support = ((*hypotheses[k].profiles).*direction).support;
    for (std::size_t i = 0; i < n; ++i) weight[i] += share[k] * support[i];
  }
  for (float& w : weight) w = std::log((total + 1) / (std::max(w, 1.0f))) / std::log(total + 1);
  return weight;
}

DirectedEvidence summary(const Profile& p, const std::vector<float>& weight) {
  DirectedEvidence out;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    out.support += static_cast<double>(p.support[i]);
    out.rare_support += static_cast<double>(p.support[i] * weight[i]);
  }
  const double n = std::max<double>(1, static_cast<double>(weight.size()));
  out.support /= n;
  out.rare_support /= n;
  out.contradiction = p.contradiction;
  out.against = p.against;
  return out;
}

// The smaller direction counts fully, since a small scan inside a large one explains itself anywhere.
double combined_support(const Hypothesis& h) {
  constexpr double kLarger = 0.25;
  return std::min(h.source.rare_support, h.target.rare_support) +
         kLarger * std::max(h.source.rare_support, h.target.rare_support);
}

// Of what lies in sight of the other station, how much contradicts it: at true poses 0.1-5 %, more in thinned scans.
double free_space_factor(const Hypothesis& h) {
  constexpr double kDecay = 0.035;
  const auto share = [](const DirectedEvidence& e) {
    return e.contradiction / std::max(e.contradiction + e.support, 1e-9);
  };
  return std::exp(-0.5 * (share(h.source) + share(h.target)) / kDecay);
}

// Planes that all face one way, a floor or one wall, fix no place: such a pose explains much and can lie anywhere along
// them. Of 597 right poses of 30 sets twelve had a smallest stiffness below 2 % of the largest; three in
// four of the wrong ones that scans of offices were laid in had less than 0.03 %.
double observed_factor(const Profile& forward, const Profile& backward, const Transform& target_from_source) {
  constexpr double kObserved = 0.02, kLeast = 0.05;
  const Eigen::Matrix3f turn = target_from_source.linear().cast<float>();
  const Eigen::Matrix3f stiffness = forward.stiffness + turn * backward.stiffness * turn.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  const Eigen::Vector3f of_axes = solver.computeDirect(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(of_axes[2] > 0)) return 1;
  return std::clamp(static_cast<double>(of_axes[0] / of_axes[2]) / kObserved, kLeast, 1.0);
}

// Where the vertical of both scans is known, a pose that turns them apart is doubtful: at right poses of seven sets
// they lay within 1.7 degrees of each other, and nearby tilted poses often explained as much. A doubt, no ban: the
// vertical of a hillside is that of its surface; and none where the turn is wide: then one of the two is no vertical.
double upright_factor(const ScanModel& source, const ScanModel& target, const Transform& target_from_source) {
  constexpr double kFreeDeg = 1, kSigmaDeg = 1.5, kLeast = 0.05, kNoVerticalDeg = 15;
  const std::vector<DominantAxis>&from = source.features.axes, &to = target.features.axes;
  if (from.empty() || to.empty() || !from.front().upright || !to.front().upright) return 1;
  const Eigen::Vector3d turned = target_from_source.linear() * from.front().direction.cast<double>();
  const double cosine = std::min(1.0, std::abs(turned.dot(to.front().direction.cast<double>())));
  const double tilt_deg = std::acos(cosine) * 180 / std::numbers::pi;
  if (tilt_deg > kNoVerticalDeg) return 1;
  const double beyond = std::max(0.0, tilt_deg - kFreeDeg) / kSigmaDeg;
  return std::max(kLeast, std::exp(-0.5 * beyond * beyond));
}

// What the evidence of `h` and its profiles is worth.
double score_of(const ScanModel& source, const ScanModel& target, const Hypothesis& h, const Profile& forward,
                const Profile& backward, const Weighing& weighing) {
  return combined_support(h) * (weighing.free_space ? free_space_factor(h) : 1.0) *
         (weighing.upright ? upright_factor(source, target, h.target_from_source) : 1.0) *
         (weighing.observed ? observed_factor(forward, backward, h.target_from_source) : 1.0);
}

// The score of one pose alone, every point weighing the same.
double score_alone(const ScanModel& source, const ScanModel& target, std::span<const std::uint32_t> from,
                   std::span<const std::uint32_t> to, const Transform& target_from_source, float widened_m = 0) {
  const Profile forward = profile(source, target, target_from_source, from, widened_m),
                backward = profile(target, source, target_from_source.inverse(), to, widened_m);
  Hypothesis h;
  h.target_from_source = target_from_source;
  h.source = summary(forward, std::vector<float>(from.size(), 1.0f));
  h.target = summary(backward, std::vector<float>(to.size(), 1.0f));
  return score_of(source, target, h, forward, backward, {});
}

// Mean of the source points that lie on the target's surface, and how far they reach from it.
std::pair<Eigen::Vector3d, double> middle_of_overlap(const ScanModel& source, const ScanModel& target,
                                                     std::span<const std::uint32_t> from, const Transform& t) {
  const Profile p = profile(source, target, t, from);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0, sq = 0;
  for (std::size_t k = 0; k < from.size(); ++k)
    sum += static_cast<double>(p.support[k]) * source.points[from[k]].cast<double>(),
        weight += static_cast<double>(p.support[k]);
  if (!(weight > 0)) return {source.centroid.cast<double>(), static_cast<double>(source.extent_m)};
  const Eigen::Vector3d middle = sum / weight;
  for (std::size_t k = 0; k < from.size(); ++k)
    sq += static_cast<double>(p.support[k]) * (source.points[from[k]].cast<double>() - middle).squaredNorm();
  return {middle, std::max(std::sqrt(sq / weight), 5 * static_cast<double>(source.voxel_m))};
}

}  // namespace

void climb(const ScanModel& source, const ScanModel& target, std::size_t max_points, double first_step_voxels,
           Hypothesis& hypothesis) {
  constexpr double kLastStepVoxels = 0.125;
  constexpr int kMaxRounds = 12;
  const auto from = even_sample(source, max_points), to = even_sample(target, max_points);
  const auto [middle, reach] = middle_of_overlap(source, target, from, hypothesis.target_from_source);
  // A step in the source's frame about the middle of the overlap.
  const auto step_of = [&middle = middle, &reach = reach](int axis, double step_m) {
    Transform d = Transform::Identity();
    if (axis < 3) {
      d.translation()[axis] = step_m;
      return d;
    }
    const Eigen::Matrix3d turn = rotation_from_vector(Eigen::Vector3d::Unit(axis - 3) * (step_m / reach));
    d.linear() = turn;
    d.translation() = middle - turn * middle;
    return d;
  };
  // widening: of the tolerance, in steps; a step must be able to reach what it is meant for.
  const auto climbed = [&](Transform pose, double widening) {
    double step = first_step_voxels, best = 0;
    bool known = false;  // best, at the tolerance of this step
    for (int round = 0; round < kMaxRounds && step >= kLastStepVoxels; ++round) {
      const double step_m = step * static_cast<double>(source.voxel_m);
      const auto widened_m = static_cast<float>(widening * step_m);
      if (!known) best = score_alone(source, target, from, to, pose, widened_m), known = true;
      bool moved = false;
      for (int axis = 0; axis < 6; ++axis)
        for (const double sign : {1.0, -1.0}) {
          const Transform tried = pose * step_of(axis, sign * step_m);
          const double score = score_alone(source, target, from, to, tried, widened_m);
          if (score <= best) continue;
          best = score, pose = tried, moved = true;
          break;  // the other way only if this one fails
        }
      if (!moved) step /= 2, known = false;
    }
    return pose;
  };
  constexpr double kWidening = 0.5;
  const Transform start = hypothesis.target_from_source;
  const double before = score_alone(source, target, from, to, start);
  for (const double widening : {kWidening, 0.0}) {  // along a flat ridge the wide tolerance may wander off
    const Transform end = climbed(start, widening);
    if (score_alone(source, target, from, to, end) <= before) continue;
    hypothesis.target_from_source = end;
    break;
  }
  hypothesis.target_from_source = orthonormalised(hypothesis.target_from_source);
}

namespace {

constexpr std::size_t kMinMatches = 12;

// A few matches on a line could throw a hypothesis anywhere: no step moves the scan by more than a few voxels.
StepLimit step_limit(const ScanModel& source) {
  constexpr double kMaxMoveVoxels = 2, kMaxTurnVoxels = 4;
  const float voxel = source.voxel_m;
  return {kMaxMoveVoxels * static_cast<double>(voxel),
          kMaxTurnVoxels * static_cast<double>(voxel / std::max(source.extent_m, voxel))};
}

// Source points against target planes and target points against source planes in one system, about the source's
// centroid in the target frame.
NormalEquations both_ways(const ScanModel& source, const ScanModel& target, const Transform& t,
                          std::span<const std::uint32_t> from, std::span<const std::uint32_t> to, float gate,
                          MatchWeights weights = MatchWeights::alike) {
  NormalEquations forward, backward;
  add_point_to_plane(source, target, t, from, false, gate, t * source.centroid.cast<double>(), forward, weights);
  add_point_to_plane(target, source, t.inverse(), to, false, gate, source.centroid.cast<double>(), backward, weights);
  // The backward step moves the target in the source frame; seen from the target it is the inverse motion: x -> -R x.
  Matrix6d to_target = Matrix6d::Zero();
  to_target.topLeftCorner<3, 3>() = -t.linear();
  to_target.bottomRightCorner<3, 3>() = -t.linear();
  forward.a += to_target * backward.a * to_target.transpose();
  forward.b += to_target * backward.b;
  forward.weight += backward.weight;
  forward.sq_residual_sum += backward.sq_residual_sum;
  forward.matches += backward.matches;
  return forward;
}

double rms_of(const NormalEquations& e) { return std::sqrt(e.sq_residual_sum / std::max(e.weight, 1e-12)); }

// Gate of the last steps: what surfaces leave between them, robustly (Rousseeuw, Croux 1993: 1.4826 times the median of
// absolute residuals), not what corners and foliage leave; at most `widest`.
float gate_of_residuals(const ScanModel& source, const ScanModel& target, const Transform& t,
                        std::span<const std::uint32_t> from, std::span<const std::uint32_t> to, float widest) {
  constexpr float kSigmas = 2.5f, kSigmaOfMedian = 1.4826f, kNarrowestVoxels = 0.02f;
  std::vector<float> distances = distances_to_planes(source, target, t, from, widest);
  const std::vector<float> backward = distances_to_planes(target, source, t.inverse(), to, widest);
  distances.insert(distances.end(), backward.begin(), backward.end());
  if (distances.size() < kMinMatches) return widest;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return std::clamp(kSigmas * kSigmaOfMedian * *middle, kNarrowestVoxels * source.voxel_m, widest);
}

// Steps with a gate as narrow as the residuals allow, flat surfaces before rough ones, until they stand still.
void align_closely(const ScanModel& source, const ScanModel& target, std::size_t max_points, Hypothesis& hypothesis) {
  constexpr int kMaxSteps = 12;
  constexpr std::size_t kGatePoints = 4000;
  constexpr double kStillVoxels = 2e-4;
  const auto from = even_sample(source, max_points), to = even_sample(target, max_points);
  const auto gate_from = even_sample(source, kGatePoints), gate_to = even_sample(target, kGatePoints);
  const double voxel = static_cast<double>(source.voxel_m), reach = static_cast<double>(source.extent_m);
  Transform t = hypothesis.target_from_source;
  auto weights = MatchWeights::by_roughness;
  for (int step = 0; step < kMaxSteps; ++step) {
    const float gate = gate_of_residuals(source, target, t, gate_from, gate_to, 0.5f * source.voxel_m);
    NormalEquations equations = both_ways(source, target, t, from, to, gate, weights);
    if (step == 0) {
      const NormalEquations alike = both_ways(source, target, t, from, to, gate);
      if (!flat_surfaces_hold(equations, alike)) weights = MatchWeights::alike, equations = alike;
    }
    if (equations.matches < kMinMatches) break;
    const Eigen::Vector3d middle = t * source.centroid.cast<double>();
    const Transform moved = solved_step(equations, middle, voxel, step_limit(source));
    t = moved * t;
    hypothesis.rms_m = rms_of(equations);
    const double motion = (moved * middle - middle).norm() + reach * rotation_angle_rad(moved.linear());
    if (motion < kStillVoxels * voxel) break;
  }
  hypothesis.target_from_source = orthonormalised(t);
}

}  // namespace

void polish(const ScanModel& source, const ScanModel& target, std::size_t max_points, int steps,
            Hypothesis& hypothesis) {
  const auto from = even_sample(source, max_points), to = even_sample(target, max_points);
  constexpr double kMinKept = 0.6;  // a step that loses the surface is taken back
  Transform t = hypothesis.target_from_source, before = t;
  std::size_t matches_before = 0;
  const float voxel = source.voxel_m;
  for (int step = 0; step < steps; ++step) {
    const float gate = voxel * (step * 2 < steps ? 1.0f : 0.5f);
    const NormalEquations equations = both_ways(source, target, t, from, to, gate);
    const std::size_t matches = equations.matches;
    if (static_cast<double>(matches) < kMinKept * static_cast<double>(matches_before)) {
      t = before;
      break;
    }
    if (matches < kMinMatches) break;
    // The gate halves half-way and drops matches by itself: compare only steps with the same gate.
    matches_before = (step + 1) * 2 >= steps && step * 2 < steps ? 0 : matches;
    before = t;
    t = solved_step(equations, t * source.centroid.cast<double>(), static_cast<double>(voxel), step_limit(source)) * t;
    hypothesis.rms_m = rms_of(equations);
  }
  hypothesis.target_from_source = orthonormalised(t);
}

void polish_closely_unless_worse(const ScanModel& source, const ScanModel& target, std::size_t max_points, int steps,
                                 Hypothesis& hypothesis) {
  constexpr std::size_t kScorePoints = 2000;
  constexpr double kKept = 0.98;  // of the score: within what the sample of points makes of it
  const auto from = even_sample(source, kScorePoints), to = even_sample(target, kScorePoints);
  const double before = score_alone(source, target, from, to, hypothesis.target_from_source);
  const auto take_unless_worse = [&](const Hypothesis& moved) {
    if (score_alone(source, target, from, to, moved.target_from_source) >= kKept * before) hypothesis = moved;
  };
  Hypothesis polished = hypothesis;
  polish(source, target, max_points, steps, polished);
  take_unless_worse(polished);
  Hypothesis aligned = hypothesis;
  align_closely(source, target, max_points, aligned);
  take_unless_worse(aligned);
}

bool same_basin(const ScanModel& source, const Transform& a, const Transform& b) {
  constexpr double kBasinVoxels = 6,
                   kBasinRad = 0.09;  // what polishing the same answer leaves in rough or sparse scans
  const Eigen::Vector3d middle = source.centroid.cast<double>();
  if ((a * middle - b * middle).norm() > kBasinVoxels * source.scan.voxel_m) return false;
  return rotation_angle_rad(a.linear().transpose() * b.linear()) < kBasinRad;
}

void keep_distinct(const ScanModel& source, double position_m, std::vector<Hypothesis>& hypotheses) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  const Eigen::Vector3d middle = source.centroid.cast<double>();
  const double reach = static_cast<double>(source.extent_m);
  std::vector<Hypothesis> kept;
  for (const Hypothesis& h : hypotheses) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      const Eigen::Vector3d moved = h.target_from_source * middle - k.target_from_source * middle;
      if (moved.norm() > position_m) return false;
      const double turn = rotation_angle_rad(k.target_from_source.linear().transpose() * h.target_from_source.linear());
      return turn * reach < 2 * position_m;
    });
    if (!known) kept.push_back(h);
  }
  hypotheses = std::move(kept);
}

void weigh(const ScanModel& source, const ScanModel& target, const Weighing& weighing,
           std::vector<Hypothesis>& hypotheses) {
  const auto from = even_sample(source, weighing.max_points), to = even_sample(target, weighing.max_points);
  parallel_for_index(hypotheses.size(), 4, [&](std::size_t k) {
    Hypothesis& h = hypotheses[k];
    const Transform& t = h.target_from_source;
    if (h.profiles && h.profiles->source == &source && h.profiles->max_points == weighing.max_points &&
        h.profiles->target_from_source.matrix() == t.matrix())
      return;
    h.profiles = std::make_shared<const PoseProfiles>(PoseProfiles{
        t, &source, weighing.max_points, profile(source, target, t, from), profile(target, source, t.inverse(), to)});
  });
  std::vector<float> share(hypotheses.size(), 0.0f);
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    float alike = 0;
    for (const Hypothesis& h : hypotheses)
      alike += same_basin(source, h.target_from_source, hypotheses[k].target_from_source);
    share[k] = 1 / alike;
  }
  const auto weights = [&](const Profile PoseProfiles::*direction, std::size_t n) {
    return weighing.rarity ? rarity(hypotheses, direction, share, n) : std::vector<float>(n, 1.0f);
  };
  const std::vector<float> from_weight = weights(&PoseProfiles::forward, from.size()),
                           to_weight = weights(&PoseProfiles::backward, to.size());
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    Hypothesis& h = hypotheses[k];
    h.source = summary(h.profiles->forward, from_weight);
    h.target = summary(h.profiles->backward, to_weight);
    h.score = score_of(source, target, h, h.profiles->forward, h.profiles->backward, weighing);
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
}

}  // namespace isthmus
