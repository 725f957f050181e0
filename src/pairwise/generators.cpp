#include "pairwise/generators.h"

#include <array>
#include <limits>

#include "regions/column_votes.h"
#include "regions/pair_votes.h"
#include "regions/pose_votes.h"
#include "regions/stem_votes.h"

namespace isthmus {
namespace {

// The seeds of `vote(source axis, target axis)` for the likeliest pairs of common axes, at most `most`.
template <class Vote>
std::vector<Seed> seeds_about_common_axes(const GeneratorContext& c, std::size_t most, Vote&& vote) {
  auto axes = common_axes(c.source.features.axes, c.target.features.axes);
  if (axes.size() > most) axes.resize(most);
  std::vector<Seed> seeds;
  for (const auto& [from, to] : axes) {
    const std::vector<Seed> more = vote(from, to);
    seeds.insert(seeds.end(), more.begin(), more.end());
  }
  return seeds;
}

std::vector<Seed> axis_votes(const GeneratorContext& c) {
  VoteOptions options;
  options.matches_per_keypoint = static_cast<std::uint32_t>(c.options.matches_per_keypoint);
  options.window_voxels = static_cast<float>(c.options.vote_window_voxels);
  constexpr auto kAll = std::numeric_limits<std::size_t>::max();
  return seeds_about_common_axes(c, kAll, [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    return vote_seeds_about_axis(c.source, c.target, c.matches, from, to, options);
  });
}

std::vector<Seed> column_votes(const GeneratorContext& c) {
  constexpr std::size_t kMaxAxisPairs = 3;
  return seeds_about_common_axes(c, kMaxAxisPairs, [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    return vote_seeds_by_columns(c.source, c.target, from, to, {});
  });
}

std::vector<Seed> stem_votes(const GeneratorContext& c) {
  constexpr std::size_t kMaxAxisPairs = 2;
  return seeds_about_common_axes(c, kMaxAxisPairs, [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    return vote_seeds_by_stems(c.source, c.target, from, to, {});
  });
}

std::vector<Seed> pair_votes(const GeneratorContext& c) {
  return vote_seeds_by_pairs(c.source, c.target, c.matches, {});
}

}  // namespace

std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> common_axes(std::span<const DominantAxis> from,
                                                                     std::span<const DominantAxis> to) {
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> out;
  const bool uprights = !from.empty() && !to.empty() && from.front().upright && to.front().upright;
  for (std::size_t a = 0; a < (uprights ? 1 : from.size()); ++a)
    for (std::size_t b = 0; b < (uprights ? 1 : to.size()); ++b) {
      if (a > 0 && b > 0) continue;
      out.emplace_back(from[a].direction, to[b].direction);
      if (!from[a].knows_its_end() || !to[b].knows_its_end()) out.emplace_back(from[a].direction, -to[b].direction);
    }
  return out;
}

std::span<const Generator> generators() {
  const auto always = [](const std::vector<Seed>&) { return true; };
  static const std::array<Generator, 4> table{{{"stem_votes", stem_votes, true, stems_settle},
                                               {"column_votes", column_votes, true, always},
                                               {"axis_votes", axis_votes, false},
                                               {"pair_votes", pair_votes, false}}};
  return table;
}

}  // namespace isthmus
