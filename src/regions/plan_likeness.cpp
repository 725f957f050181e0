#include "regions/plan_likeness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "regions/shift_votes.h"

namespace isthmus {
namespace {

constexpr float kSameFacing = 0.4f;  // radians
constexpr float kReachCells = 1.2f;  // a column meets one this near

// The columns of a plan by their cells: one a cell at most.
class ColumnsByCell {
 public:
  explicit ColumnsByCell(const GroundPlan& plan)
      : plan_(plan), size_(2 * static_cast<std::int64_t>(std::ceil(plan.radius_m / plan.cell_m)) + 3) {
    at_.assign(static_cast<std::size_t>(size_ * size_), kNone);
    for (std::uint32_t j = 0; j < plan.columns.size(); ++j) {
      const Column& c = plan.columns[j];
      at_[static_cast<std::size_t>(cell(c.p.y()) * size_ + cell(c.p.x()))] = j;
      if (c.faces)
        facing_[bin_of(c.heading)] += 1;
      else
        open_ += 1;
    }
  }

  // The nearest column that may be this one.
  [[nodiscard]] const Column* nearest(const Eigen::Vector2f& p, bool faces, float heading) const {
    const float reach = kReachCells * plan_.cell_m;
    const std::int64_t x = cell(p.x()), y = cell(p.y());
    const Column* found = nullptr;
    float sq_nearest = reach * reach;
    for (std::int64_t v = std::max<std::int64_t>(0, y - 1); v <= std::min(size_ - 1, y + 1); ++v)
      for (std::int64_t u = std::max<std::int64_t>(0, x - 1); u <= std::min(size_ - 1, x + 1); ++u) {
        const std::uint32_t j = at_[static_cast<std::size_t>(v * size_ + u)];
        if (j == kNone) continue;
        const Column& c = plan_.columns[j];
        if (c.faces != faces || (faces && std::abs(wrapped(heading - c.heading)) > kSameFacing)) continue;
        if (const float sq = (c.p - p).squaredNorm(); sq < sq_nearest) sq_nearest = sq, found = &c;
      }
    return found;
  }

  // That a column of this facing, put anywhere on the plan, meets one.
  [[nodiscard]] float chance(bool faces, float heading) const {
    constexpr float kLeast = 1e-3f;
    constexpr std::size_t kAlikeBins = 2;  // to either side: about the same facing
    float alike = open_;
    if (faces) {
      alike = 0;
      const std::size_t middle = bin_of(wrapped(heading)) + kBins;
      for (std::size_t b = middle - kAlikeBins; b <= middle + kAlikeBins; ++b) alike += facing_[b % kBins];
    }
    const float reach_share = kReachCells * plan_.cell_m / std::max(plan_.radius_m, plan_.cell_m);
    return std::max(kLeast, 1 - std::exp(-alike * reach_share * reach_share));
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  static constexpr std::size_t kBins = 32;

  static std::size_t bin_of(float heading) {
    constexpr float kPi = std::numbers::pi_v<float>;
    return static_cast<std::size_t>((heading + kPi) / (2 * kPi) * kBins) % kBins;
  }
  [[nodiscard]] std::int64_t cell(float value) const {
    return static_cast<std::int64_t>(std::floor(value / plan_.cell_m)) + size_ / 2;
  }

  const GroundPlan& plan_;
  std::int64_t size_;
  std::vector<std::uint32_t> at_;
  std::array<float, kBins> facing_{};
  float open_ = 0;
};

// The most that agrees on one shift of heights, to two bins; ends of columns vote for it.
float agreeing(std::vector<std::pair<std::int64_t, float>>& votes) {
  std::sort(votes.begin(), votes.end());
  float best = 0, before = 0;
  std::int64_t bin_before = 0;
  for (std::size_t i = 0; i < votes.size();) {
    const std::int64_t bin = votes[i].first;
    float sum = 0;
    for (; i < votes.size() && votes[i].first == bin; ++i) sum += votes[i].second;
    best = std::max(best, sum + (bin == bin_before + 1 ? before : 0));
    before = sum, bin_before = bin;
  }
  return best;
}

float score_of(const GroundPlan& source, const ColumnsByCell& target, const PlanPose& pose, float bin_m) {
  const Eigen::Rotation2Df turn(pose.yaw);
  std::vector<std::pair<std::int64_t, float>> heights;
  const auto bin = [bin_m](float shift) { return static_cast<std::int64_t>(std::floor(shift / bin_m)); };
  for (const Column& c : source.columns) {
    const Column* met = target.nearest(turn * c.p + pose.shift, c.faces, c.heading + pose.yaw);
    if (met == nullptr) continue;
    const float worth = -c.weight * std::log(target.chance(c.faces, c.heading + pose.yaw));
    heights.emplace_back(bin(met->bottom - c.bottom), worth);
    heights.emplace_back(bin(met->top - c.top), worth);
  }
  return agreeing(heights);
}

// What lies near enough to be shared: the grids below are as wide as the plan, and a tower three kilometres away would
// make them fill the memory.
GroundPlan near_part(const GroundPlan& plan) {
  constexpr float kFarthestCells = 300;
  if (plan.radius_m <= kFarthestCells * plan.cell_m) return plan;
  GroundPlan near = plan;
  std::erase_if(near.columns, [&](const Column& c) { return c.p.norm() > kFarthestCells * plan.cell_m; });
  near.radius_m = kFarthestCells * plan.cell_m;
  return near;
}

// The rarest of a plan vote for all of the other: fewer of these find the same places in less time.
GroundPlan voters_of(const GroundPlan& plan) {
  constexpr std::size_t kVoters = 250;
  GroundPlan voters = plan;
  if (voters.columns.size() <= kVoters) return voters;
  std::ranges::stable_sort(voters.columns, std::ranges::greater(), &Column::weight);
  voters.columns.resize(kVoters);
  return voters;
}

}  // namespace

float plan_likeness(const GroundPlan& whole_source, const GroundPlan& whole_target) {
  const GroundPlan source = near_part(whole_source), target = near_part(whole_target);
  constexpr std::size_t kMinColumns = 8, kPeaksPerTurn = 12, kPeaks = 20;
  constexpr float kYawStepRad = 0.06f;  // 3.4 degrees
  constexpr float kElsewhereCells = 4, kElsewhereRad = 0.2f;
  constexpr float kHeightBinCells = 2.0f / 3;
  if (source.columns.size() < kMinColumns || target.columns.size() < kMinColumns) return 0;
  const GroundPlan voters = voters_of(source);
  const ShiftVotes votes(voters, target, target.cell_m);
  const std::vector<PlanPose> peaks =
      heaviest_shifts(votes, likely_turns(source, target, kYawStepRad), kPeaksPerTurn, kPeaks);
  if (peaks.empty()) return 0;
  const ColumnsByCell columns(target);
  std::vector<float> scores;
  for (const PlanPose& pose : peaks) scores.push_back(score_of(source, columns, pose, kHeightBinCells * target.cell_m));
  const auto best = static_cast<std::size_t>(std::ranges::max_element(scores) - scores.begin());
  float elsewhere = 0;
  for (std::size_t k = 0; k < peaks.size(); ++k)
    if ((peaks[k].shift - peaks[best].shift).norm() > kElsewhereCells * target.cell_m ||
        std::abs(wrapped(peaks[k].yaw - peaks[best].yaw)) > kElsewhereRad)
      elsewhere = std::max(elsewhere, scores[k]);
  return scores[best] - elsewhere;
}

GroundPlan upside_down(GroundPlan plan) {
  for (Column& c : plan.columns) {
    c.p.y() = -c.p.y(), c.heading = -c.heading;
    const float bottom = c.bottom;
    c.bottom = -c.top, c.top = -bottom;
  }
  for (Level& l : plan.levels) l.p.y() = -l.p.y(), l.z = -l.z, l.up = !l.up;
  return plan;
}

}  // namespace isthmus
