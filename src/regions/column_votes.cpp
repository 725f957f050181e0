#include "regions/column_votes.h"

#include <algorithm>

#include "base/parallel.h"
#include "regions/grow.h"
#include "regions/shift_votes.h"

namespace isthmus {
namespace {

std::size_t stride_for(const ScanModel& model, std::size_t points) {
  return std::max<std::size_t>(1, model.points.size() / points);
}

}  // namespace

std::vector<Seed> vote_seeds_by_columns(const ScanModel& source, const ScanModel& target,
                                        const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                        const ColumnVoteOptions& options) {
  constexpr std::size_t kMinColumns = 8, kLeastPeaksPerTurn = 24;
  const Eigen::Matrix3f z_from_source = z_from_axis(source_axis), z_from_target = z_from_axis(target_axis);
  const auto from_plan = ground_plan(source, z_from_source, options.plan),
             to_plan = ground_plan(target, z_from_target, options.plan);
  const GroundPlan &from = *from_plan, &to = *to_plan;
  if (from.columns.size() < kMinColumns || to.columns.size() < kMinColumns || source.regions.regions.empty()) return {};
  const float voxel = source.voxel_m, cell = options.plan.cell_voxels * voxel;
  const ShiftVotes votes(from, to, cell);
  const std::vector<float> turns = likely_turns(from, to, options.yaw_step_rad);
  const std::size_t per_turn =
      std::max(kLeastPeaksPerTurn, options.max_checked / std::max<std::size_t>(1, turns.size()));
  const std::vector<PlanPose> peaks = heaviest_shifts(votes, turns, per_turn, options.max_checked);

  const PlanHeights heights(to, cell);
  std::vector<Pose3f> poses;
  std::vector<float> votes_of_pose;
  for (const PlanPose& peak : peaks)
    for (const float z : heights.shifts(from, peak, voxel)) {
      poses.push_back(pose_of_plan(source, target, z_from_source, z_from_target, peak, z));
      votes_of_pose.push_back(peak.votes);
    }

  // Which of them hold in three dimensions, over the whole scans? A glance at all, a look at the better ones.
  std::vector<std::uint32_t> order(poses.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  std::vector<float> score(poses.size());
  const auto keep_best = [&](std::size_t points, std::size_t keep) {
    const std::size_t from_stride = stride_for(source, points), to_stride = stride_for(target, points);
    parallel_for_index(order.size(), 16, [&](std::size_t i) {
      const Pose3f& pose = poses[order[i]];
      score[order[i]] = ranking_score(score_direction(source, target, pose, {}, from_stride, true),
                                      score_direction(target, source, pose.inverse(), {}, to_stride, true));
    });
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return score[a] > score[b]; });
    if (order.size() > keep) order.resize(keep);
  };
  constexpr std::size_t kGlancePoints = 150, kLookPoints = 600, kLooks = 3;
  keep_best(kGlancePoints, kLooks * options.max_seeds);
  keep_best(kLookPoints, options.max_seeds);

  std::vector<Pose3f> kept;
  for (const std::uint32_t k : order) kept.push_back(poses[k]);
  std::vector<Seed> seeds = seeds_at_poses(source, target, kept);
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    seeds[s].votes = votes_of_pose[order[s]];
    seeds[s].score = score[order[s]];
    seeds[s].generator = "column votes";
  }
  return seeds;
}

}  // namespace isthmus
