#include "regions/pair_votes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/parallel.h"
#include "geometry/point_grid.h"

namespace isthmus {
namespace {

struct WindowMatch {
  Eigen::Vector3f p, n, q, m;  // source point and normal, target point and normal
  float similarity;
  float weight;
  std::uint32_t keypoint;
};

struct PoseVote {
  Eigen::Quaternionf rotation;
  Eigen::Vector3f centre;
  float weight;
  std::uint32_t a, b;  // keypoints of the pair
};

// A frame on an oriented pair: x along the baseline, y towards the normals' common side.
bool frame_of(const Eigen::Vector3f& baseline, const Eigen::Vector3f& normals, Eigen::Matrix3f& frame) {
  const Eigen::Vector3f x = baseline.normalized();
  const Eigen::Vector3f y = normals - normals.dot(x) * x;
  constexpr float kMinSide = 0.3f;  // shorter: the normals lie along the baseline and fix no turn about it
  if (y.norm() < kMinSide) return false;
  frame.col(0) = x;
  frame.col(1) = y.normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return true;
}

bool agrees(const WindowMatch& a, const WindowMatch& b, float voxel, const PairVoteOptions& o) {
  const Eigen::Vector3f dp = b.p - a.p, dq = b.q - a.q;
  const float lp = dp.norm(), lq = dq.norm();
  if (lp < o.min_baseline_voxels * voxel || std::abs(lp - lq) > o.distance_tolerance_voxels * voxel) return false;
  if (std::abs(a.n.dot(b.n) - a.m.dot(b.m)) > o.cosine_tolerance) return false;
  if (std::abs(a.n.dot(dp) / lp - a.m.dot(dq) / lq) > o.cosine_tolerance) return false;
  if (std::abs(b.n.dot(dp) / lp - b.m.dot(dq) / lq) > o.cosine_tolerance) return false;
  const float handed_p = a.n.cross(b.n).dot(dp) / lp, handed_q = a.m.cross(b.m).dot(dq) / lq;
  return std::abs(handed_p - handed_q) <= 1.5f * o.cosine_tolerance;
}

std::uint64_t cell_key(const PoseVote& v, float position_cell, float rotation_cell) {
  const auto cell = [](float value, float size) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size)));
  };
  std::uint64_t key = 0;
  for (int a = 0; a < 3; ++a) key = key << 13 | (cell(v.centre[a], position_cell) & 0x1fff);
  for (int a = 0; a < 3; ++a) key = key << 6 | (cell(v.rotation.vec()[a] + 1.01f, rotation_cell) & 0x3f);
  return key;
}

struct PosePeak {
  Eigen::Quaternionf rotation;
  Eigen::Vector3f centre;
  float weight;
};

PosePeak mean_shift(const std::vector<PoseVote>& votes, const PoseVote& start, float position_m, float rotation,
                    std::vector<float>& best_of_keypoint) {
  PosePeak peak{start.rotation, start.centre, 0};
  for (int step = 0; step < 3; ++step) {
    std::fill(best_of_keypoint.begin(), best_of_keypoint.end(), 0.0f);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Vector4f turn = Eigen::Vector4f::Zero();
    float weight = 0;
    for (const PoseVote& v : votes) {
      const float sq = (v.centre - peak.centre).squaredNorm() / (position_m * position_m);
      if (sq > 1) continue;
      const float dot = v.rotation.dot(peak.rotation);
      const float sq_turn = 2 * (1 - std::abs(dot)) / (rotation * rotation);
      if (sq + sq_turn > 1) continue;
      const float w = v.weight * (1 - sq - sq_turn);
      sum += w * v.centre;
      turn += (dot < 0 ? -w : w) * v.rotation.coeffs();
      weight += w;
      best_of_keypoint[v.a] = std::max(best_of_keypoint[v.a], v.weight);
      best_of_keypoint[v.b] = std::max(best_of_keypoint[v.b], v.weight);
    }
    if (!(weight > 0)) break;
    peak.centre = sum / weight;
    peak.rotation.coeffs() = turn.normalized();
  }
  for (const float w : best_of_keypoint) peak.weight += w;
  return peak;
}

}  // namespace

std::vector<Seed> vote_seeds_by_pairs(const ScanModel& source, const ScanModel& target, const MatchTable& matches,
                                      const PairVoteOptions& options) {
  const auto& keypoints = source.features.keypoints;
  std::vector<Eigen::Vector3f> points(keypoints.size());
  for (std::size_t k = 0; k < keypoints.size(); ++k) points[k] = source.points[keypoints[k]];
  std::vector<std::uint32_t> popularity(target.features.keypoints.size(), 0);
  const std::uint32_t used = std::min(options.matches_per_keypoint, matches.count);
  for (std::size_t k = 0; k < keypoints.size(); ++k)
    for (std::uint32_t r = 0; r < used; ++r) ++popularity[matches.target[k * matches.count + r]];

  const float voxel = source.voxel_m, window = options.window_voxels * voxel;
  const PointGrid grid(points, window);
  const auto& regions = source.regions.regions;
  std::vector<std::vector<Seed>> seeds_of_region(regions.size());
  parallel_for_index(regions.size(), 2, [&](std::size_t r) {
    const Eigen::Vector3f centre = regions[r].centre;
    std::vector<WindowMatch> window_matches;
    std::uint32_t members = 0;
    grid.for_each_within(centre, window, [&](std::uint32_t k, float) {
      for (std::uint32_t rank = 0; rank < used; ++rank) {
        const std::uint32_t t = matches.target[static_cast<std::size_t>(k) * matches.count + rank];
        const std::uint32_t i = keypoints[k], j = target.features.keypoints[t];
        window_matches.push_back({source.points[i], source.normals[i], target.points[j], target.normals[j],
                                  matches.similarity[static_cast<std::size_t>(k) * matches.count + rank],
                                  1.0f / std::sqrt(static_cast<float>(popularity[t])), members});
      }
      ++members;
    });
    if (window_matches.size() > options.max_matches) {
      std::stable_sort(window_matches.begin(), window_matches.end(),
                       [](const auto& a, const auto& b) { return a.similarity > b.similarity; });
      window_matches.resize(options.max_matches);
    }
    std::vector<PoseVote> votes;
    constexpr std::size_t kMaxVotes = 20000;
    for (std::size_t a = 0; a < window_matches.size() && votes.size() < kMaxVotes; ++a)
      for (std::size_t b = a + 1; b < window_matches.size(); ++b) {
        const WindowMatch &ma = window_matches[a], &mb = window_matches[b];
        if (ma.keypoint == mb.keypoint || !agrees(ma, mb, voxel, options)) continue;
        Eigen::Matrix3f from, to;
        if (!frame_of(mb.p - ma.p, ma.n + mb.n, from) || !frame_of(mb.q - ma.q, ma.m + mb.m, to)) continue;
        PoseVote vote;
        const Eigen::Matrix3f rotation = to * from.transpose();
        vote.rotation = Eigen::Quaternionf(rotation);
        if (vote.rotation.w() < 0) vote.rotation.coeffs() = -vote.rotation.coeffs();
        vote.centre = 0.5f * (ma.q + mb.q) + rotation * (centre - 0.5f * (ma.p + mb.p));
        vote.weight = std::sqrt(ma.weight * mb.weight);
        vote.a = ma.keypoint, vote.b = mb.keypoint;
        votes.push_back(vote);
      }
    const float position_cell = options.position_cell_voxels * voxel;
    std::unordered_map<std::uint64_t, std::pair<float, std::uint32_t>> cells;
    cells.reserve(votes.size());
    for (std::uint32_t v = 0; v < votes.size(); ++v) {
      auto& cell = cells.try_emplace(cell_key(votes[v], position_cell, options.rotation_cell), 0.0f, v).first->second;
      cell.first += votes[v].weight;
    }
    std::vector<std::pair<float, std::uint32_t>> heaviest;
    for (const auto& [key, cell] : cells) heaviest.push_back(cell);
    const std::size_t keep = std::min<std::size_t>(heaviest.size(), 2 * options.peaks_per_region);
    std::partial_sort(
        heaviest.begin(), heaviest.begin() + static_cast<std::ptrdiff_t>(keep), heaviest.end(),
        [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    std::vector<float> best_of_keypoint(members);
    std::vector<PosePeak> peaks;
    for (std::size_t c = 0; c < keep; ++c) {
      const PosePeak peak = mean_shift(votes, votes[heaviest[c].second], 1.2f * position_cell,
                                       1.5f * options.rotation_cell, best_of_keypoint);
      const bool known = std::any_of(peaks.begin(), peaks.end(), [&](const PosePeak& p) {
        return (p.centre - peak.centre).norm() < position_cell && std::abs(p.rotation.dot(peak.rotation)) > 0.995f;
      });
      if (!known) peaks.push_back(peak);
    }
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const PosePeak& a, const PosePeak& b) { return a.weight > b.weight; });
    if (peaks.size() > options.peaks_per_region) peaks.resize(options.peaks_per_region);
    for (const PosePeak& peak : peaks) {
      Seed seed;
      seed.source_region = static_cast<std::uint32_t>(r);
      seed.rotation = peak.rotation.toRotationMatrix();
      seed.centre_in_target = peak.centre;
      seed.votes = peak.weight;
      seed.generator = "pair votes";
      seeds_of_region[r].push_back(seed);
    }
  });
  std::vector<Seed> seeds;
  for (const auto& part : seeds_of_region) seeds.insert(seeds.end(), part.begin(), part.end());
  return seeds;
}

}  // namespace isthmus
