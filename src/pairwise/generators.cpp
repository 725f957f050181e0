#include "pairwise/generators.h"

#include <algorithm>
#include <array>

#include "regions/pair_votes.h"
#include "regions/pose_votes.h"

namespace isthmus {
namespace {

// The strongest axis of one scan may be any axis of the other; a sign that the normals leave open is tried both ways.
std::vector<Seed> axis_votes(const GeneratorContext& c) {
  constexpr float kSureSign = 0.9f;
  VoteOptions options;
  options.matches_per_keypoint = static_cast<std::uint32_t>(c.options.matches_per_keypoint);
  options.window_voxels = static_cast<float>(c.options.vote_window_voxels);
  std::vector<Seed> seeds;
  const auto add = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    const auto more = vote_seeds_about_axis(c.source, c.target, c.matches, from, to, options);
    seeds.insert(seeds.end(), more.begin(), more.end());
  };
  const auto &from = c.source.features.axes, &to = c.target.features.axes;
  for (std::size_t a = 0; a < from.size(); ++a)
    for (std::size_t b = 0; b < to.size(); ++b) {
      if (a > 0 && b > 0) continue;
      add(from[a].direction, to[b].direction);
      if (std::min(from[a].sign_agreement, to[b].sign_agreement) < kSureSign) add(from[a].direction, -to[b].direction);
    }
  return seeds;
}

std::vector<Seed> pair_votes(const GeneratorContext& c) { return vote_seeds_by_pairs(c.source, c.target, c.matches, {}); }

}  // namespace

std::span<const Generator> generators() {
  static const std::array<Generator, 2> table{{{"axis_votes", axis_votes}, {"pair_votes", pair_votes}}};
  return table;
}

}  // namespace isthmus
