#include "regions/pose_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kMinHorizontal = 0.35f;       // below it the normal gives no heading
constexpr float kAxisAngleTolerance = 0.22f;  // difference of the normals' components along the axis
constexpr std::uint32_t kSlots = 1 << 14;     // of the vote table: more than votes of a window

struct Oriented {
  Eigen::Vector3f p;
  float heading = 0;  // of the normal about the axis
  float along = 0;    // component of the normal along the axis
  bool usable = false;
};

// Keypoints in a frame whose z is the axis.
std::vector<Oriented> aligned_keypoints(const ScanModel& model, const Eigen::Matrix3f& z_from_axis) {
  std::vector<Oriented> out(model.features.keypoints.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::uint32_t i = model.features.keypoints[k];
    const Eigen::Vector3f n = z_from_axis * model.normals[i];
    out[k].p = z_from_axis * model.points[i];
    out[k].along = n.z();
    out[k].heading = std::atan2(n.y(), n.x());
    out[k].usable = std::hypot(n.x(), n.y()) > kMinHorizontal;
  }
  return out;
}

struct Vote {
  Eigen::Vector3f centre;
  float yaw;
  float weight;
  std::uint32_t keypoint;
};

float wrapped(float angle) {
  while (angle > kPi) angle -= 2 * kPi;
  while (angle < -kPi) angle += 2 * kPi;
  return angle;
}

struct Peak {
  Eigen::Vector3f centre;
  float yaw = 0, weight = 0;
};

// Open-addressing table of vote cells, cleared for each window.
class VoteTable {
 public:
  VoteTable() : keys_(kSlots, 0), weights_(kSlots, 0) {}
  void clear() {
    for (const std::uint32_t slot : used_) keys_[slot] = 0, weights_[slot] = 0;
    used_.clear();
  }
  bool full() const { return used_.size() > kSlots / 2; }
  void add(std::uint64_t key, float weight, std::uint32_t vote) {
    std::uint64_t h = key * 0x9E3779B97F4A7C15ULL;
    auto slot = static_cast<std::uint32_t>(h >> 50);
    while (keys_[slot] != 0 && keys_[slot] != key + 1) slot = (slot + 1) & (kSlots - 1);
    if (keys_[slot] == 0) {
      keys_[slot] = key + 1;
      used_.push_back(slot);
      if (first_.size() < kSlots) first_.resize(kSlots);
      first_[slot] = vote;
    }
    weights_[slot] += weight;
  }
  /// (weight, first vote) of the heaviest cells, heaviest first, ties in order of appearance.
  std::vector<std::pair<float, std::uint32_t>> heaviest(std::size_t n) const {
    std::vector<std::pair<float, std::uint32_t>> cells;
    for (const std::uint32_t slot : used_) cells.emplace_back(weights_[slot], first_[slot]);
    const auto better = [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    };
    n = std::min(n, cells.size());
    std::partial_sort(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(n), cells.end(), better);
    cells.resize(n);
    return cells;
  }

 private:
  std::vector<std::uint64_t> keys_;
  std::vector<float> weights_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> used_;
};

// Moves a cell's first vote to the mean of the votes around it; a keypoint counts once, with its best vote.
Peak mean_shift(const std::vector<Vote>& votes, const Vote& start, float position_m, float yaw_rad,
                std::vector<float>& best_of_keypoint) {
  Peak peak{start.centre, start.yaw, 0};
  for (int step = 0; step < 2; ++step) {
    std::fill(best_of_keypoint.begin(), best_of_keypoint.end(), 0.0f);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float yaw_sum = 0, weight_sum = 0;
    for (const Vote& v : votes) {
      const float sq = (v.centre - peak.centre).squaredNorm() / (position_m * position_m);
      const float turn = wrapped(v.yaw - peak.yaw);
      const float d = sq + turn * turn / (yaw_rad * yaw_rad);
      if (d > 1.0f) continue;
      const float w = v.weight * (1.0f - d);
      sum += w * (v.centre - peak.centre);
      yaw_sum += w * turn;
      weight_sum += w;
      best_of_keypoint[v.keypoint] = std::max(best_of_keypoint[v.keypoint], v.weight);
    }
    if (!(weight_sum > 0)) break;
    peak.centre += sum / weight_sum;
    peak.yaw = wrapped(peak.yaw + yaw_sum / weight_sum);
  }
  for (const float w : best_of_keypoint) peak.weight += w;
  return peak;
}

}  // namespace

std::vector<Seed> vote_seeds_about_axis(const ScanModel& source, const ScanModel& target, const MatchTable& matches,
                                        const Eigen::Vector3f& source_axis, const Eigen::Vector3f& target_axis,
                                        const VoteOptions& options) {
  const auto up = [](const Eigen::Vector3f& axis) {
    return Eigen::Quaternionf::FromTwoVectors(axis, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  };
  const Eigen::Matrix3f z_from_source = up(source_axis), z_from_target = up(target_axis);
  const std::vector<Oriented> from = aligned_keypoints(source, z_from_source),
                              to = aligned_keypoints(target, z_from_target);

  // Matches that respect the axis; a target keypoint that everyone matches tells little, nor does a flat similarity
  // profile.
  struct Allowed {
    std::uint32_t target;
    float yaw;
  };
  std::vector<std::vector<Allowed>> allowed(from.size());
  std::vector<std::uint32_t> popularity(to.size(), 0);
  for (std::uint32_t k = 0; k < from.size(); ++k) {
    if (!from[k].usable) continue;
    for (std::uint32_t r = 0; r < matches.count && allowed[k].size() < options.matches_per_keypoint; ++r) {
      const std::uint32_t t = matches.target[static_cast<std::size_t>(k) * matches.count + r];
      if (!to[t].usable || std::abs(to[t].along - from[k].along) > kAxisAngleTolerance) continue;
      allowed[k].push_back({t, wrapped(to[t].heading - from[k].heading)});
      ++popularity[t];
    }
  }

  std::vector<Eigen::Vector3f> points(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) points[k] = from[k].p;
  const float voxel = source.voxel_m, window = options.window_voxels * voxel;
  const PointGrid grid(points, window);
  const float cell = options.position_cell_voxels * voxel;
  const auto& regions = source.regions.regions;
  std::vector<std::vector<Seed>> seeds_of_region(regions.size());
  parallel_for_index(regions.size(), 4, [&](std::size_t r) {
    const Eigen::Vector3f centre = z_from_source * regions[r].centre;
    std::vector<Vote> votes;
    std::vector<std::uint32_t> members;
    grid.for_each_within(centre, window, [&](std::uint32_t k, float) { members.push_back(k); });
    VoteTable table;
    for (std::uint32_t local = 0; local < members.size(); ++local) {
      const std::uint32_t k = members[local];
      for (const Allowed& match : allowed[k]) {
        const float c = std::cos(match.yaw), s = std::sin(match.yaw);
        const Eigen::Vector3f d = centre - from[k].p;
        Vote vote;
        vote.centre = to[match.target].p + Eigen::Vector3f(c * d.x() - s * d.y(), s * d.x() + c * d.y(), d.z());
        vote.yaw = match.yaw;
        vote.weight = 1.0f / std::sqrt(static_cast<float>(popularity[match.target]));
        vote.keypoint = local;
        const auto q = [&](float value, float size) {
          return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size)) & 0xffff);
        };
        if (!table.full())
          table.add(q(vote.centre.x(), cell) << 48 | q(vote.centre.y(), cell) << 32 | q(vote.centre.z(), cell) << 16 |
                        q(vote.yaw + kPi, options.yaw_cell_rad),
                    vote.weight, static_cast<std::uint32_t>(votes.size()));
        votes.push_back(vote);
      }
    }
    std::vector<float> best_of_keypoint(members.size());
    std::vector<Peak> peaks;
    for (const auto& [weight, first] : table.heaviest(2 * options.peaks_per_region)) {
      const Peak peak = mean_shift(votes, votes[first], 1.2f * cell, 1.2f * options.yaw_cell_rad, best_of_keypoint);
      const bool known = std::any_of(peaks.begin(), peaks.end(), [&](const Peak& p) {
        return (p.centre - peak.centre).norm() < cell && std::abs(wrapped(p.yaw - peak.yaw)) < options.yaw_cell_rad;
      });
      if (!known) peaks.push_back(peak);
    }
    std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.weight > b.weight; });
    if (peaks.size() > options.peaks_per_region) peaks.resize(options.peaks_per_region);
    for (const Peak& peak : peaks) {
      Seed seed;
      seed.source_region = static_cast<std::uint32_t>(r);
      seed.rotation = z_from_target.transpose() *
                      Eigen::AngleAxisf(peak.yaw, Eigen::Vector3f::UnitZ()).toRotationMatrix() * z_from_source;
      seed.centre_in_target = z_from_target.transpose() * peak.centre;
      seed.votes = peak.weight;
      seed.generator = "axis votes";
      seeds_of_region[r].push_back(seed);
    }
  });
  std::vector<Seed> seeds;
  for (const auto& part : seeds_of_region) seeds.insert(seeds.end(), part.begin(), part.end());
  return seeds;
}

}  // namespace isthmus
