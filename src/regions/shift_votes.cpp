#include "regions/shift_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"

namespace isthmus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

ShiftVotes::ShiftVotes(const GroundPlan& source, const GroundPlan& target, float cell_m)
    : source_(source), target_(target), cell_m_(cell_m), reach_m_(source.radius_m + target.radius_m) {
  size_ = static_cast<std::size_t>(2 * reach_m_ / cell_m) + 3;
  bins_.resize(kBins);
  for (std::uint32_t j = 0; j < target.columns.size(); ++j) {
    const Column& c = target.columns[j];
    if (!c.faces) {
      open_.push_back(j);
      continue;
    }
    bins_[bin_of(c.heading)].push_back(j);
  }
}

ShiftVotes::Grid ShiftVotes::grid() const {
  const std::vector<float> zeros(size_ * size_, 0.0f);
  return {zeros, zeros, zeros};
}

std::vector<PlanPose> ShiftVotes::peaks(float yaw, std::size_t count, Grid& grid) const {
  std::vector<float>& votes = grid.votes;
  std::fill(votes.begin(), votes.end(), 0.0f);
  const Eigen::Rotation2Df turn(yaw);
  for (const Column& c : source_.columns) {
    const Eigen::Vector2f p = turn * c.p;
    const auto vote = [&](const std::vector<std::uint32_t>& bin) {
      for (const std::uint32_t j : bin) {
        const Column& t = target_.columns[j];
        const Eigen::Vector2f g = (t.p - p).array() / cell_m_ + offset();
        votes[static_cast<std::size_t>(g.y()) * size_ + static_cast<std::size_t>(g.x())] += c.weight * t.weight;
      }
    };
    if (!c.faces) {  // a trunk seen from all sides meets trunks, and what faces anywhere
      vote(open_);
      continue;
    }
    const int middle = static_cast<int>(bin_of(wrapped(c.heading + yaw)));
    for (int d = -kReachBins; d <= kReachBins; ++d) vote(bins_[static_cast<std::size_t>((middle + d + kBins) % kBins)]);
  }
  return heaviest(grid, yaw, count);
}

std::size_t ShiftVotes::bin_of(float heading) {
  return static_cast<std::size_t>((heading + kPi) / (2 * kPi) * kBins) % kBins;
}

std::vector<PlanPose> ShiftVotes::heaviest(Grid& grid, float yaw, std::size_t count) const {
  const std::size_t n = size_;
  const std::vector<float>& votes = grid.votes;
  std::vector<float>&rows = grid.rows, &sums = grid.sums;  // their borders stay zero
  for (std::size_t y = 0; y < n; ++y)
    for (std::size_t x = 1; x + 1 < n; ++x)
      rows[y * n + x] = votes[y * n + x - 1] + votes[y * n + x] + votes[y * n + x + 1];
  for (std::size_t y = 1; y + 1 < n; ++y)
    for (std::size_t x = 1; x + 1 < n; ++x)
      sums[y * n + x] = rows[(y - 1) * n + x] + rows[y * n + x] + rows[(y + 1) * n + x];
  std::vector<std::pair<float, std::uint32_t>> best;
  for (std::size_t y = 1; y + 1 < n; ++y)
    for (std::size_t x = 1; x + 1 < n; ++x) {
      const std::size_t k = y * n + x;
      const float s = sums[k];
      if (!(s > 0) || (best.size() == count && s <= best.front().first)) continue;
      if (s < sums[k - 1] || s <= sums[k + 1] || s < sums[k - n] || s <= sums[k + n]) continue;
      if (best.size() == count) {
        std::pop_heap(best.begin(), best.end(), std::greater<>());
        best.pop_back();
      }
      best.emplace_back(s, static_cast<std::uint32_t>(k));
      std::push_heap(best.begin(), best.end(), std::greater<>());
    }
  std::sort(best.begin(), best.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  std::vector<PlanPose> out;
  for (const auto& [s, k] : best) {
    Eigen::Vector2f mean = Eigen::Vector2f::Zero();
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const std::size_t at = k + static_cast<std::size_t>(dy) * n + static_cast<std::size_t>(dx);
        mean += votes[at] * Eigen::Vector2f(static_cast<float>(at % n), static_cast<float>(at / n));
      }
    const Eigen::Vector2f g = (mean / s).array() + 0.5f - offset();
    out.push_back({yaw, g * cell_m_, s});
  }
  return out;
}

std::vector<float> likely_turns(const GroundPlan& source, const GroundPlan& target, float step_rad) {
  constexpr float kLeastShare = 0.5f;  // of the best agreement
  const auto n = static_cast<std::size_t>(std::ceil(2 * kPi / step_rad));
  const auto histogram = [n](const GroundPlan& plan) {
    std::vector<float> bins(n, 0.0f);
    for (const Column& c : plan.columns)
      if (c.faces)
        bins[static_cast<std::size_t>((c.heading + kPi) / (2 * kPi) * static_cast<float>(n)) % n] += c.weight;
    return bins;
  };
  const std::vector<float> from = histogram(source), to = histogram(target);
  std::vector<float> agreement(n, 0.0f);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = i + k;
      agreement[k] += from[i] * (0.5f * to[(j + n - 1) % n] + to[j % n] + 0.5f * to[(j + 1) % n]);
    }
  const float best = *std::max_element(agreement.begin(), agreement.end());
  std::vector<float> turns;
  for (std::size_t k = 0; k < n; ++k)
    if (agreement[k] >= kLeastShare * best)
      turns.push_back(wrapped(static_cast<float>(k) * 2 * kPi / static_cast<float>(n)));
  return turns;
}

std::vector<PlanPose> heaviest_shifts(const ShiftVotes& votes, const std::vector<float>& turns, std::size_t per_turn,
                                      std::size_t keep) {
  constexpr std::size_t kTogether = 12;
  std::vector<std::vector<PlanPose>> of_turn(turns.size());
  parallel_for_index((turns.size() + kTogether - 1) / kTogether, 1, [&](std::size_t part) {
    ShiftVotes::Grid grid = votes.grid();
    for (std::size_t k = part * kTogether; k < std::min(turns.size(), (part + 1) * kTogether); ++k)
      of_turn[k] = votes.peaks(turns[k], per_turn, grid);
  });
  std::vector<PlanPose> peaks;
  for (const auto& part : of_turn) peaks.insert(peaks.end(), part.begin(), part.end());
  std::stable_sort(peaks.begin(), peaks.end(), [](const PlanPose& a, const PlanPose& b) { return a.votes > b.votes; });
  if (peaks.size() > keep) peaks.resize(keep);
  return peaks;
}

}  // namespace isthmus
