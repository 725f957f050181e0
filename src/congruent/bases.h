// Bases: four nearly coplanar source points whose diagonals cross.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/rng.h"
#include "congruent/oriented_cloud.h"

namespace isthmus::congruent {

/// Points a, b, c, d; the diagonals ab and cd cross inside both, e1 = a + r1 (b - a) meeting e2 = c + r2 (d - c).
/// The ratios, lengths and the angle survive any rigid motion; the ratios survive any affine one (Aiger, Mitra,
/// Cohen-Or 2008).
struct Base {
  std::array<std::uint32_t, 4> points{};  ///< indices into the source
  double r1 = 0;
  double r2 = 0;
  double gap_m = 0;      ///< |e1 - e2|, 0 for exactly coplanar points
  double length1_m = 0;  ///< |b - a|
  double length2_m = 0;  ///< |d - c|
  double cos_angle = 0;  ///< between b - a and d - c
};

/// Orders four points so that their diagonals cross. Nothing when no pairing crosses well inside (one point within the
/// triangle of the others, collinear or coincident points). When two pairings do (possible only off a plane), the one
/// with the smaller gap.
std::optional<Base> base_of(std::span<const Eigen::Vector3f> points, const std::array<std::uint32_t, 4>& quad);

/// What a base should be like.
struct BaseWish {
  double width_m = 0;        ///< no side or diagonal longer than this; as long as that allows
  double coplanarity_m = 0;  ///< largest gap between the diagonals
  bool at_boundary = false;  ///< corners at the boundary of the overlap where these make a base, else anywhere
};

/// Draws a wide base: large in area and, where the cloud has normals, on surfaces facing different ways, for four
/// points of one wall have congruent sets all over that wall (this preference is ours). The lot decides by indices
/// only: moving the cloud does not change the choice but for rounding. Nothing when the cloud holds no such base.
/// Bases at the boundary after Liu et al. (reference 30 of the paper this program follows; known from there only).
std::optional<Base> select_base(const LocalCloud& source, const BaseWish& wish, Rng& rng);

}  // namespace isthmus::congruent
