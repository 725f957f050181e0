#include "regions/shift_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"

namespace isthmus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Sums over 3 x 3 cells of a square grid of 3 x 3 or more, three rows at a time: all of them would not stay in cache.
class VoteSums {
 public:
  VoteSums(const std::vector<float>& votes, std::size_t n) : votes_(votes), n_(n) {
    for (auto* rows : {&across_, &sums_})
      for (std::vector<float>& row : *rows) row.assign(n, 0.0f);
    add_across(0), add_across(1), add_across(2);
    sum_up(1);
  }

  /// To the rows 1, 2, 3 ... n - 2, one after the other.
  void go_to(std::size_t y) {
    y_ = y;
    if (y + 2 < n_) {
      add_across(y + 2);
      sum_up(y + 1);
    } else {
      std::ranges::fill(sums_[(y + 1) % 3], 0.0f);
    }
  }
  [[nodiscard]] const float* row(int offset) const {
    return sums_[(y_ + static_cast<std::size_t>(3 + offset)) % 3].data();
  }
  [[nodiscard]] float heaviest() const { return heaviest_[y_ % 3]; }

 private:
  void add_across(std::size_t y) {
    const float* v = votes_.data() + y * n_;
    float* out = across_[y % 3].data();
    for (std::size_t x = 1; x + 1 < n_; ++x) out[x] = v[x - 1] + v[x] + v[x + 1];
  }
  void sum_up(std::size_t y) {
    const float *a = across_[(y - 1) % 3].data(), *b = across_[y % 3].data(), *c = across_[(y + 1) % 3].data();
    float* out = sums_[y % 3].data();
    for (std::size_t x = 1; x + 1 < n_; ++x) out[x] = a[x] + b[x] + c[x];
    constexpr std::size_t kLanes = 8;  // so that the comparisons need not wait for each other
    std::array<float, kLanes> most{};
    const std::size_t whole = n_ / kLanes * kLanes;
    for (std::size_t x = 0; x < whole; x += kLanes)
      for (std::size_t k = 0; k < kLanes; ++k) most[k] = most[k] < out[x + k] ? out[x + k] : most[k];
    for (std::size_t x = whole; x < n_; ++x) most[0] = std::max(most[0], out[x]);
    heaviest_[y % 3] = *std::ranges::max_element(most);
  }

  const std::vector<float>& votes_;
  std::size_t n_, y_ = 0;
  std::array<std::vector<float>, 3> across_, sums_;  // by row modulo 3; the first and last cell stay zero
  std::array<float, 3> heaviest_{};
};

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

std::vector<float> ShiftVotes::grid() const { return std::vector<float>(size_ * size_, 0.0f); }

std::vector<PlanPose> ShiftVotes::peaks(float yaw, std::size_t count, std::vector<float>& votes) const {
  votes.assign(size_ * size_, 0.0f);
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
  return heaviest(votes, yaw, count);
}

std::size_t ShiftVotes::bin_of(float heading) {
  return static_cast<std::size_t>((heading + kPi) / (2 * kPi) * kBins) % kBins;
}

std::vector<PlanPose> ShiftVotes::heaviest(const std::vector<float>& votes, float yaw, std::size_t count) const {
  const std::size_t n = size_;
  VoteSums sums(votes, n);
  std::vector<std::pair<float, std::uint32_t>> best;
  for (std::size_t y = 1; y + 1 < n; ++y) {
    sums.go_to(y);
    if (!(sums.heaviest() > 0) || (best.size() == count && sums.heaviest() <= best.front().first)) continue;
    const float *above = sums.row(-1), *here = sums.row(0), *below = sums.row(1);
    for (std::size_t x = 1; x + 1 < n; ++x) {
      const float s = here[x];
      if (!(s > 0) || (best.size() == count && s <= best.front().first)) continue;
      if (s < here[x - 1] || s <= here[x + 1] || s < above[x] || s <= below[x]) continue;
      if (best.size() == count) {
        std::pop_heap(best.begin(), best.end(), std::greater<>());
        best.pop_back();
      }
      best.emplace_back(s, static_cast<std::uint32_t>(y * n + x));
      std::push_heap(best.begin(), best.end(), std::greater<>());
    }
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
  constexpr std::size_t kTogether = 12;  // turns counted in one grid
  std::vector<std::vector<PlanPose>> of_turn(turns.size());
  parallel_for_index((turns.size() + kTogether - 1) / kTogether, 1, [&](std::size_t part) {
    std::vector<float> grid = votes.grid();
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
