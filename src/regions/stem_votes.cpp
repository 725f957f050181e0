#include "regions/stem_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "regions/shift_votes.h"
#include "regions/stems.h"
#include "regions/upright_memo.h"

namespace isthmus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kTallest = 160;

// A dense grid over the places of stems.
class Grid {
 public:
  Grid(const std::vector<Stem>& stems, float cell_m) : cell_m_(cell_m) {
    Eigen::Vector2f low = stems.front().centre, high = low;
    for (const Stem& s : stems) low = low.cwiseMin(s.centre), high = high.cwiseMax(s.centre);
    low_ = low.array() - cell_m;
    columns_ = static_cast<int>((high.x() - low_.x()) / cell_m) + 2;
    rows_ = static_cast<int>((high.y() - low_.y()) / cell_m) + 2;
    first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const Stem& s : stems) ++first_[at(s.centre) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    order_.resize(stems.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t k = 0; k < stems.size(); ++k) order_[next[at(stems[k].centre)]++] = k;
  }

  /// Calls f(begin, end) with the range of indices of each of the cells about p that there are.
  template <class F>
  void for_cells_about(const Eigen::Vector2f& p, F&& f) const {
    const Eigen::Vector2f g = (p - low_) / cell_m_;
    const int x = static_cast<int>(std::floor(g.x())), y = static_cast<int>(std::floor(g.y()));
    for (int row = std::max(0, y - 1); row <= std::min(rows_ - 1, y + 1); ++row) {
      const int left = std::max(0, x - 1), right = std::min(columns_ - 1, x + 1);
      if (left > right) continue;
      const auto base = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
      f(order_.data() + first_[base + static_cast<std::size_t>(left)],
        order_.data() + first_[base + static_cast<std::size_t>(right) + 1]);
    }
  }

 private:
  [[nodiscard]] std::size_t at(const Eigen::Vector2f& p) const {
    const Eigen::Vector2f g = (p - low_) / cell_m_;
    return static_cast<std::size_t>(g.y()) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(g.x());
  }
  float cell_m_;
  Eigen::Vector2f low_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> first_, order_;
};

// The target's stems, to match with and to weigh by.
class StemTarget {
 public:
  StemTarget(const std::vector<Stem>& stems, float voxel)
      : stems_(stems), voxel_(voxel), near_(stems, kReaches.front() * voxel), around_(stems, kDensityCell * voxel) {}

  // Moves the pose to where the stems agree, ever closer.
  [[nodiscard]] bool settle(const std::vector<Stem>& source, PlanPose& pose) const {
    constexpr std::size_t kMinMatched = 3;
    std::vector<std::pair<Eigen::Vector2f, Eigen::Vector2f>> pairs;
    for (const float reach : kReaches) {
      const Eigen::Rotation2Df turn(pose.yaw);
      pairs.clear();
      Eigen::Vector2f from = Eigen::Vector2f::Zero(), to = from;
      for (const Stem& s : source) {
        const Stem* match = nearest(turn * s.centre + pose.shift, reach * voxel_);
        if (!match) continue;
        pairs.emplace_back(s.centre, match->centre);
        from += s.centre, to += match->centre;
      }
      if (pairs.size() < kMinMatched) return false;
      from /= static_cast<float>(pairs.size()), to /= static_cast<float>(pairs.size());
      float sine = 0, cosine = 0;
      for (const auto& [a, b] : pairs) {
        const Eigen::Vector2f u = a - from, v = b - to;
        cosine += u.dot(v), sine += u.x() * v.y() - u.y() * v.x();
      }
      pose.yaw = std::atan2(sine, cosine);
      pose.shift = to - Eigen::Rotation2Df(pose.yaw) * from;
    }
    return true;
  }

  // Of the places of the source's stems where the target has any: stems of the target with a normal error, or chance.
  [[nodiscard]] float log_likelihood_ratio(const std::vector<Stem>& source, const PlanPose& pose) const {
    constexpr float kSigma = 0.4f;   // voxels; measured in woods at true poses
    constexpr float kFound = 0.25f;  // of the stems of one scan in sight of the other, how many that one finds as well
    constexpr float kPeak = 1 / (2 * kPi * kSigma * kSigma);
    const Eigen::Rotation2Df turn(pose.yaw);
    float sum = 0;
    for (const Stem& s : source) {
      const Eigen::Vector2f p = turn * s.centre + pose.shift;
      std::ptrdiff_t count = 0;
      around_.for_cells_about(p, [&](const auto* begin, const auto* end) { count += end - begin; });
      if (count == 0) continue;
      const float density = static_cast<float>(count) / (9 * kDensityCell * kDensityCell);  // per square voxel
      float likelihood = 0;
      if (const Stem* match = nearest(p, kReaches.back() * voxel_)) {
        const float sq_voxels = (match->centre - p).squaredNorm() / (voxel_ * voxel_);
        likelihood = kPeak * std::exp(-0.5f * sq_voxels / (kSigma * kSigma)) / density;
      }
      sum += std::log(1 - kFound + kFound * likelihood);
    }
    return sum;
  }

 private:
  static constexpr std::array<float, 5> kReaches{4.0f, 2.5f, 1.5f, 1.0f, 1.0f};  // voxels
  static constexpr float kDensityCell = 10;                                      // voxels; counted over three by three

  [[nodiscard]] const Stem* nearest(const Eigen::Vector2f& p, float reach_m) const {
    float best = reach_m * reach_m;
    const Stem* found = nullptr;
    near_.for_cells_about(p, [&](const auto* begin, const auto* end) {
      for (const auto* k = begin; k != end; ++k) {
        const float d = (stems_[*k].centre - p).squaredNorm();
        if (d < best) best = d, found = &stems_[*k];
      }
    });
    return found;
  }

  const std::vector<Stem>& stems_;
  float voxel_;
  Grid near_, around_;
};

// The tallest stems, their centres about the scan's centroid.
std::vector<Stem> tallest_stems(const ScanModel& model, const Eigen::Matrix3f& z_from_scan,
                                const StemVoteOptions& options) {
  std::vector<Stem> stems = *model.uprights().stems(
      z_from_scan, options.min_layers, [&] { return find_stems(model.scan, z_from_scan, options.min_layers); });
  std::stable_sort(stems.begin(), stems.end(), [](const Stem& a, const Stem& b) { return a.layers > b.layers; });
  if (stems.size() > options.max_stems) stems.resize(options.max_stems);
  const Eigen::Vector2f middle = (z_from_scan * model.centroid).head<2>();
  for (Stem& s : stems) s.centre -= middle;
  return stems;
}

GroundPlan plan_of(const std::vector<Stem>& stems) {
  GroundPlan plan;
  for (const Stem& s : stems) {
    Column column;
    column.p = s.centre;
    plan.columns.push_back(column);
    plan.radius_m = std::max(plan.radius_m, s.centre.norm());
  }
  return plan;
}

std::vector<PlanPose> settled_poses(const std::vector<Stem>& source, const std::vector<Stem>& target, float voxel,
                                    const StemVoteOptions& options) {
  const GroundPlan from = plan_of(source), to = plan_of(target);
  const ShiftVotes votes(from, to, options.cell_voxels * voxel);
  const auto count = static_cast<std::size_t>(std::ceil(2 * kPi / options.yaw_step_rad));
  std::vector<float> turns(count);
  for (std::size_t k = 0; k < count; ++k)
    turns[k] = wrapped(static_cast<float>(k) * 2 * kPi / static_cast<float>(count));
  std::vector<PlanPose> poses = heaviest_shifts(votes, turns, options.peaks_per_turn, options.max_settled);
  const StemTarget stems(target, voxel);
  parallel_for_index(poses.size(), 16, [&](std::size_t k) {
    poses[k].votes = stems.settle(source, poses[k]) ? stems.log_likelihood_ratio(source, poses[k]) : 0;
  });
  std::stable_sort(poses.begin(), poses.end(), [](const PlanPose& a, const PlanPose& b) { return a.votes > b.votes; });
  std::vector<PlanPose> kept;
  constexpr float kSameYaw = 0.03f, kSamePlaceVoxels = 3;
  for (const PlanPose& p : poses) {
    if (p.votes <= 0 || kept.size() == options.max_seeds) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const PlanPose& k) {
      return std::abs(wrapped(k.yaw - p.yaw)) < kSameYaw && (k.shift - p.shift).norm() < kSamePlaceVoxels * voxel;
    });
    if (!known) kept.push_back(p);
  }
  return kept;
}

std::vector<Stem> first_of(const std::vector<Stem>& stems, std::size_t count) {
  return {stems.begin(), stems.begin() + static_cast<std::ptrdiff_t>(std::min(count, stems.size()))};
}

// Far likelier than chance and than any other place.
bool beyond_doubt(float best, float other) {
  constexpr float kBeyondChance = 40;  // of 12 pairs of scans of two woods no place was likelier than chance
  constexpr float kOverOthers = 2;
  return best >= kBeyondChance && best >= kOverOthers * other;
}

bool settled(const std::vector<PlanPose>& poses) {
  return !poses.empty() && beyond_doubt(poses[0].votes, poses.size() > 1 ? poses[1].votes : 0);
}

}  // namespace

std::vector<Seed> vote_seeds_by_stems(const ScanModel& source, const ScanModel& target,
                                      const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                      const StemVoteOptions& options) {
  const Eigen::Matrix3f z_from_source = z_from_axis(source_axis), z_from_target = z_from_axis(target_axis);
  const std::vector<Stem> from = tallest_stems(source, z_from_source, options),
                          to = tallest_stems(target, z_from_target, options);
  if (from.size() < options.min_stems || to.size() < options.min_stems || source.regions.regions.empty()) return {};
  // The tallest few settle most pairs of woods at a sixth of the cost.
  std::vector<PlanPose> found;
  for (const std::size_t tallest : {kTallest, options.max_stems}) {
    found = settled_poses(first_of(from, tallest), first_of(to, tallest), source.voxel_m, options);
    if (settled(found) || std::max(from.size(), to.size()) <= tallest) break;
  }
  if (found.empty()) return {};
  const GroundPlanOptions plan;
  const auto from_plan = ground_plan(source, z_from_source, plan), to_plan = ground_plan(target, z_from_target, plan);
  const PlanHeights heights(*to_plan, plan.cell_voxels * source.voxel_m);
  std::vector<Pose3f> poses;
  std::vector<float> score;
  for (const PlanPose& pose : found)
    for (const float z : heights.shifts(*from_plan, pose, source.voxel_m)) {
      poses.push_back(pose_of_plan(source, target, z_from_source, z_from_target, pose, z));
      score.push_back(pose.votes);
    }
  std::vector<Seed> seeds = seeds_at_poses(source, target, poses);
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    seeds[s].votes = seeds[s].score = score[s];
    seeds[s].generator = "stem votes";
  }
  return seeds;
}

bool stems_settle(const std::vector<Seed>& seeds) {
  if (seeds.empty()) return false;
  const float best = seeds.front().score;
  float other = 0;  // seeds of one place, at several heights, have one score
  for (const Seed& s : seeds)
    if (s.score < best) other = std::max(other, s.score);
  return beyond_doubt(best, other);
}

}  // namespace isthmus
