#include "regions/column_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "base/parallel.h"
#include "regions/grow.h"

namespace isthmus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kMaxUpright = 0.5f;     // of a normal along the axis: walls, trunks
constexpr float kMinHorizontal = 0.8f;  // floors, ground, ceilings, tables
constexpr float kClearFacing = 0.7f;    // mean resultant length of a column's headings: below it, it faces no one way
constexpr float kFacingRad = 0.6f;      // headings of two columns that may be one

struct Column {
  Eigen::Vector2f p;   // mean of its points
  float heading = 0;   // of the mean normal
  bool faces = false;  // has one heading
  float weight = 1;
  float bottom = 0, top = 0;
};

struct Level {  // a point of a horizontal surface
  Eigen::Vector2f p;
  float z;
  bool up;
};

struct Plan {
  std::vector<Column> columns;
  std::vector<Level> levels;
  float radius_m = 0;  // of the columns about the origin of the plan
};

std::int64_t cell_of(float value, float cell_m) { return static_cast<std::int64_t>(std::floor(value / cell_m)); }

float wrapped(float angle) { return std::remainder(angle, 2 * kPi); }

// Rare facings count: the weight falls with the number of columns around that face the same way.
void weigh_columns(std::vector<Column>& columns, float cell_m) {
  constexpr float kNeighbourhoodCells = 12, kSameFacing = 0.5f;
  const float reach = kNeighbourhoodCells * cell_m;
  std::vector<float> weight(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    int alike = 0;
    for (const Column& other : columns) {
      if ((other.p - columns[i].p).squaredNorm() > reach * reach) continue;
      alike += other.faces == columns[i].faces &&
               (!other.faces || std::abs(wrapped(other.heading - columns[i].heading)) < kSameFacing);
    }
    weight[i] = 1 / std::sqrt(static_cast<float>(std::max(alike, 1)));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].weight = weight[i];
}

Plan plan_of(const ScanModel& model, const Eigen::Matrix3f& z_from_scan, const ColumnVoteOptions& options) {
  const float voxel = model.voxel_m, cell = options.cell_voxels * voxel;
  struct Pile {
    Eigen::Vector2f sum = Eigen::Vector2f::Zero(), facing = Eigen::Vector2f::Zero();
    float n = 0, bottom = std::numeric_limits<float>::infinity(), top = -std::numeric_limits<float>::infinity();
    std::vector<std::int64_t> layers;
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Pile> piles;  // sorted: the order of columns is the same everywhere
  Plan plan;
  constexpr std::size_t kMaxLevels = 250;
  std::vector<Level> levels;
  const Eigen::Vector3f middle = z_from_scan * model.centroid;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const Eigen::Vector3f p = z_from_scan * model.points[i] - middle, n = z_from_scan * model.normals[i];
    if (model.variation[i] >= 1) continue;
    if (std::abs(n.z()) > kMinHorizontal) levels.push_back({p.head<2>(), p.z(), n.z() > 0});
    if (std::abs(n.z()) > kMaxUpright) continue;
    Pile& pile = piles[{cell_of(p.x(), cell), cell_of(p.y(), cell)}];
    pile.sum += p.head<2>(), pile.facing += n.head<2>().normalized(), pile.n += 1;
    pile.bottom = std::min(pile.bottom, p.z()), pile.top = std::max(pile.top, p.z());
    pile.layers.push_back(cell_of(p.z(), voxel));
  }
  for (auto& [key, pile] : piles) {
    std::sort(pile.layers.begin(), pile.layers.end());
    const auto layers = std::unique(pile.layers.begin(), pile.layers.end()) - pile.layers.begin();
    if (layers < options.min_height_voxels) continue;
    Column column;
    column.p = pile.sum / pile.n;
    column.heading = std::atan2(pile.facing.y(), pile.facing.x());
    column.faces = pile.facing.norm() > kClearFacing * pile.n;
    column.bottom = pile.bottom, column.top = pile.top;
    plan.columns.push_back(column);
  }
  weigh_columns(plan.columns, cell);
  if (plan.columns.size() > options.max_columns) {  // the rarest; ties in the order of cells
    std::stable_sort(plan.columns.begin(), plan.columns.end(),
                     [](const Column& a, const Column& b) { return a.weight > b.weight; });
    plan.columns.resize(options.max_columns);
  }
  for (const Column& c : plan.columns) plan.radius_m = std::max(plan.radius_m, c.p.norm());
  const std::size_t stride = std::max<std::size_t>(1, levels.size() / kMaxLevels);
  for (std::size_t i = 0; i < levels.size(); i += stride) plan.levels.push_back(levels[i]);
  return plan;
}

// Turns at which the headings of the two plans agree: all of them in a wood, four in a house.
std::vector<float> likely_turns(const Plan& source, const Plan& target, float step_rad) {
  constexpr float kLeastShare = 0.5f;  // of the best agreement
  const auto n = static_cast<std::size_t>(std::ceil(2 * kPi / step_rad));
  const auto histogram = [n](const Plan& plan) {
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

struct Peak {
  float yaw = 0;
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  float votes = 0;
};

// The heaviest shifts of one turn. `to` is sorted into bins of heading, so that only columns that may be one meet.
class ShiftVotes {
 public:
  ShiftVotes(const Plan& source, const Plan& target, float cell_m)
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

  [[nodiscard]] std::vector<Peak> peaks(float yaw, std::size_t count) const {
    std::vector<float> votes(size_ * size_, 0.0f);
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
      for (int d = -kReachBins; d <= kReachBins; ++d)
        vote(bins_[static_cast<std::size_t>((middle + d + kBins) % kBins)]);
    }
    return heaviest(votes, yaw, count);
  }

 private:
  static constexpr int kBins = 32;
  static constexpr int kReachBins = 3;  // within about kFacingRad
  static_assert(kReachBins * 2 * 3.14159f / kBins < kFacingRad + 0.1f);

  static std::size_t bin_of(float heading) {
    return static_cast<std::size_t>((heading + kPi) / (2 * kPi) * kBins) % kBins;
  }
  [[nodiscard]] float offset() const { return 1 + reach_m_ / cell_m_; }

  // Sums over 3 x 3 cells, local maxima only.
  [[nodiscard]] std::vector<Peak> heaviest(const std::vector<float>& votes, float yaw, std::size_t count) const {
    const std::size_t n = size_;
    std::vector<float> rows(n * n, 0.0f), sums(n * n, 0.0f);
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
    std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<Peak> out;
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

  const Plan& source_;
  const Plan& target_;
  float cell_m_, reach_m_;
  std::size_t size_ = 0;
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::uint32_t> open_;
};

// What stands over each cell of the target's plan: heights of floors and ceilings, and where columns begin.
class Heights {
 public:
  Heights(const Plan& plan, float cell_m) : cell_m_(cell_m) {
    for (const Level& l : plan.levels) at_[key(l.p)].push_back({l.z, l.up ? kUp : kDown});
    for (const Column& c : plan.columns) {
      at_[key(c.p)].push_back({c.bottom, kBottom});
      at_[key(c.p)].push_back({c.top, kTop});
    }
  }

  /// The one or two shifts along the axis on which most of the source's heights agree.
  [[nodiscard]] std::vector<float> shifts(const Plan& source, const Peak& peak, float bin_m) const {
    std::map<std::int64_t, float> votes;
    const Eigen::Rotation2Df turn(peak.yaw);
    const auto vote = [&](const Eigen::Vector2f& p, float z, int kind, float weight) {
      const auto found = at_.find(key(turn * p + peak.shift));
      if (found == at_.end()) return;
      for (const auto& [height, other] : found->second)
        if (other == kind) votes[cell_of(height - z, bin_m)] += weight / static_cast<float>(found->second.size());
    };
    for (const Level& l : source.levels) vote(l.p, l.z, l.up ? kUp : kDown, 1);
    const std::size_t stride = std::max<std::size_t>(1, source.columns.size() / kMaxColumns);
    for (std::size_t i = 0; i < source.columns.size(); i += stride) {
      const Column& c = source.columns[i];
      vote(c.p, c.bottom, kBottom, c.weight), vote(c.p, c.top, kTop, c.weight);
    }
    std::vector<std::pair<float, std::int64_t>> sums;
    for (const auto& [bin, weight] : votes) {
      const auto next = votes.find(bin + 1), before = votes.find(bin - 1);
      sums.emplace_back(
          weight + (next != votes.end() ? next->second : 0) + (before != votes.end() ? before->second : 0), bin);
    }
    std::stable_sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<float> out;
    for (const auto& [weight, bin] : sums) {
      const float z = (static_cast<float>(bin) + 0.5f) * bin_m;
      constexpr std::size_t kMost = 2;
      constexpr float kApartBins = 2.5f;
      if (!out.empty() && std::abs(z - out.front()) < kApartBins * bin_m) continue;
      out.push_back(z);
      if (out.size() == kMost) break;
    }
    return out;
  }

 private:
  static constexpr std::size_t kMaxColumns = 200;  // whose ends are compared
  enum Kind { kUp, kDown, kBottom, kTop };
  [[nodiscard]] std::uint64_t key(const Eigen::Vector2f& p) const {
    return static_cast<std::uint64_t>(cell_of(p.x(), cell_m_)) << 32 ^
           (static_cast<std::uint64_t>(cell_of(p.y(), cell_m_)) & 0xffffffffULL);
  }
  float cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<float, int>>> at_;
};

std::size_t stride_for(const ScanModel& model, std::size_t points) {
  return std::max<std::size_t>(1, model.points.size() / points);
}

}  // namespace

std::vector<Seed> vote_seeds_by_columns(const ScanModel& source, const ScanModel& target,
                                        const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                        const ColumnVoteOptions& options) {
  constexpr std::size_t kMinColumns = 8, kPeaksPerTurn = 24;
  const auto up = [](const Eigen::Vector3f& axis) {
    return Eigen::Quaternionf::FromTwoVectors(axis, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  };
  const Eigen::Matrix3f z_from_source = up(source_axis), z_from_target = up(target_axis);
  const Plan from = plan_of(source, z_from_source, options), to = plan_of(target, z_from_target, options);
  if (from.columns.size() < kMinColumns || to.columns.size() < kMinColumns || source.regions.regions.empty()) return {};
  const float voxel = source.voxel_m, cell = options.cell_voxels * voxel;
  const ShiftVotes votes(from, to, cell);
  const std::vector<float> turns = likely_turns(from, to, options.yaw_step_rad);
  std::vector<std::vector<Peak>> peaks_of_turn(turns.size());
  parallel_for_index(turns.size(), 4, [&](std::size_t k) { peaks_of_turn[k] = votes.peaks(turns[k], kPeaksPerTurn); });
  std::vector<Peak> peaks;
  for (const auto& part : peaks_of_turn) peaks.insert(peaks.end(), part.begin(), part.end());
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.votes > b.votes; });
  if (peaks.size() > options.max_checked) peaks.resize(options.max_checked);

  const Heights heights(to, cell);
  const Eigen::Vector3f source_middle = z_from_source * source.centroid,
                        target_middle = z_from_target * target.centroid;
  std::vector<Pose3f> poses;
  std::vector<float> votes_of_pose;
  for (const Peak& peak : peaks)
    for (const float z : heights.shifts(from, peak, voxel)) {
      const Eigen::Matrix3f turn = Eigen::AngleAxisf(peak.yaw, Eigen::Vector3f::UnitZ()).toRotationMatrix();
      Pose3f pose;
      pose.rotation = z_from_target.transpose() * turn * z_from_source;
      pose.translation = z_from_target.transpose() *
                         (target_middle + Eigen::Vector3f(peak.shift.x(), peak.shift.y(), z) - turn * source_middle);
      poses.push_back(pose);
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

  std::vector<Seed> seeds(order.size());
  parallel_for_index(order.size(), 4, [&](std::size_t s) {
    const Pose3f& pose = poses[order[s]];
    // Growth begins in the region with the most support around it.
    std::vector<std::uint32_t> sample;
    for (std::uint32_t i = 0; i < source.points.size();
         i += static_cast<std::uint32_t>(stride_for(source, kLookPoints)))
      sample.push_back(i);
    const PointVerdicts verdicts = judge_points(source, target, pose, sample, true);
    const auto& regions = source.regions.regions;
    constexpr float kReachVoxels = 30;
    float best = -1;
    Seed& seed = seeds[s];
    for (std::uint32_t r = 0; r < regions.size(); ++r) {
      float here = 0;
      for (std::size_t i = 0; i < sample.size(); ++i)
        if (verdicts[i] == PointVerdict::supported)
          here += std::max(0.0f, 1 - (source.points[sample[i]] - regions[r].centre).norm() / (kReachVoxels * voxel));
      if (here > best) best = here, seed.source_region = r;
    }
    seed.rotation = pose.rotation;
    seed.centre_in_target = pose * regions[seed.source_region].centre;
    seed.votes = votes_of_pose[order[s]];
    seed.score = score[order[s]];
    seed.generator = "column votes";
  });
  return seeds;
}

}  // namespace isthmus
