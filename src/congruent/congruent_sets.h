// Congruent sets: two pairs of the target whose crossing points coincide, at the base's angle.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "congruent/cosine_interval.h"
#include "congruent/pairs.h"

namespace isthmus::congruent {

/// Target points that stand for a, b, c, d of the base.
using CongruentSet = std::array<std::uint32_t, 4>;

struct SetQuery {
  double r1 = 0;           ///< the crossing lies at first + r1 (second - first) of a pair for ab
  double r2 = 0;           ///< and likewise of a pair for cd
  double max_gap_m = 0;    ///< how far the two crossings may lie apart
  CosineInterval angle{};  ///< between the directions of the two pairs
  /// Between the normals of a and c, a and d, b and c, b and d; compared only when normals are given.
  std::array<CosineInterval, 4> between_normals{};
};

struct SetCounts {
  std::uint64_t gap_tests = 0;  ///< crossing against crossing
};

/// True if the two pairs answer the query; the one definition that the grid and its brute-force twin share.
bool are_congruent(const SetQuery& query, std::span<const Eigen::Vector3f> points,
                   std::span<const Eigen::Vector3f> normals, PointPair ab, PointPair cd);

/// Every set that answers the query, in a deterministic order; nothing when there are more than `max_sets`. Crossings
/// of `ab` go into a hash grid indexed by position and, within a cell, by direction (Mellado, Aiger, Mitra 2014), so
/// that those of `cd` meet only crossings nearby at about the right angle.
std::optional<std::vector<CongruentSet>> find_congruent_sets(
    const SetQuery& query, std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
    std::span<const PointPair> ab, std::span<const PointPair> cd, std::size_t max_sets, SetCounts& counts);

}  // namespace isthmus::congruent
