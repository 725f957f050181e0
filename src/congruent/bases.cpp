#include "congruent/bases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

namespace isthmus::congruent {
namespace {

constexpr double kNearestToEnd = 0.1;       // a crossing nearer to an end says little about that end
constexpr double kSmallestSine = 0.17;      // diagonals within 10 degrees of each other cross anywhere
constexpr int kTriangleDraws = 60;          // pairs (b, c) drawn for a first point
constexpr int kAttempts = 8;                // first points drawn
constexpr std::size_t kFourthDraws = 1500;  // points looked at for the fourth corner
constexpr double kShortestSide = 0.15;      // of the width: shorter sides say little
constexpr double kFlatWeight = 0.15;        // what a base on one plane is worth beside one on three orthogonal ones

using Quad = std::array<std::uint32_t, 4>;

// Where the lines ab and cd come nearest to each other (Ericson 2005, Real-Time Collision Detection, 5.1.9).
std::optional<Base> crossing(std::span<const Eigen::Vector3f> points, const Quad& q) {
  const Eigen::Vector3d a = points[q[0]].cast<double>(), c = points[q[2]].cast<double>();
  const Eigen::Vector3d ab = points[q[1]].cast<double>() - a, cd = points[q[3]].cast<double>() - c;
  const double uu = ab.squaredNorm(), vv = cd.squaredNorm(), uv = ab.dot(cd);
  const double sq_cross = uu * vv - uv * uv;
  if (!(sq_cross > kSmallestSine * kSmallestSine * uu * vv)) return std::nullopt;
  const Eigen::Vector3d ca = a - c;
  const double ud = ab.dot(ca), vd = cd.dot(ca);
  Base base{.points = q, .r1 = (uv * vd - vv * ud) / sq_cross, .r2 = (uu * vd - uv * ud) / sq_cross};
  const auto inside = [](double r) { return r >= kNearestToEnd && r <= 1 - kNearestToEnd; };
  if (!inside(base.r1) || !inside(base.r2)) return std::nullopt;
  base.gap_m = (ca + base.r1 * ab - base.r2 * cd).norm();
  base.length1_m = std::sqrt(uu);
  base.length2_m = std::sqrt(vv);
  base.cos_angle = uv / (base.length1_m * base.length2_m);
  return base;
}

double area_of(const Base& base) {
  return 0.5 * base.length1_m * base.length2_m * std::sqrt(std::max(0.0, 1 - base.cos_angle * base.cos_angle));
}

// Volume spanned by three unit normals: 1 when they are orthogonal, 0 when they lie in one plane.
double spread(const LocalCloud& cloud, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (cloud.normals.empty()) return 0;
  return std::abs(static_cast<double>(cloud.normals[a].dot(cloud.normals[b].cross(cloud.normals[c]))));
}

double spread(const LocalCloud& cloud, const Quad& q) {
  return std::max({spread(cloud, q[0], q[1], q[2]), spread(cloud, q[0], q[1], q[3]), spread(cloud, q[0], q[2], q[3]),
                   spread(cloud, q[1], q[2], q[3])});
}

bool side_fits(const LocalCloud& cloud, std::uint32_t i, std::uint32_t j, double width_m) {
  const double side = static_cast<double>((cloud.points[i] - cloud.points[j]).norm());
  return side <= width_m && side >= kShortestSide * width_m;
}

// The points that corners are drawn from: all, or some.
class Corners {
 public:
  explicit Corners(std::size_t all) : size_(all) {}
  explicit Corners(std::span<const std::uint32_t> some) : size_(some.size()), some_(some) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::uint32_t operator[](std::size_t k) const {
    return some_.empty() ? static_cast<std::uint32_t>(k) : some_[k];
  }

 private:
  std::size_t size_;
  std::span<const std::uint32_t> some_;
};

struct Triangle {
  std::uint32_t a = 0, b = 0, c = 0;
  double worth = 0;
};

Triangle draw_triangle(const LocalCloud& cloud, const Corners& corners, double width_m, Rng& rng) {
  const auto draw = [&] { return corners[rng.below(corners.size())]; };
  Triangle best{.a = draw()};
  for (int i = 0; i < kTriangleDraws; ++i) {
    const std::uint32_t b = draw(), c = draw();
    if (!side_fits(cloud, best.a, b, width_m) || !side_fits(cloud, best.a, c, width_m) ||
        !side_fits(cloud, b, c, width_m))
      continue;
    const Eigen::Vector3f ab = cloud.points[b] - cloud.points[best.a], ac = cloud.points[c] - cloud.points[best.a];
    const double worth = static_cast<double>(ab.cross(ac).norm()) * (kFlatWeight + spread(cloud, best.a, b, c));
    if (worth > best.worth) best.b = b, best.c = c, best.worth = worth;
  }
  return best;
}

// The best fourth corner to a triangle; looks at all corners, or at an evenly spaced share of many.
std::optional<Base> with_fourth_corner(const LocalCloud& cloud, const Corners& corners, const Triangle& t,
                                       const BaseWish& wish, Rng& rng) {
  const Eigen::Vector3f origin = cloud.points[t.a];
  const Eigen::Vector3f normal = (cloud.points[t.b] - origin).cross(cloud.points[t.c] - origin).normalized();
  const std::size_t step = 1 + (corners.size() - 1) / kFourthDraws;
  std::optional<Base> best;
  double best_worth = 0;
  for (std::size_t k = rng.below(step); k < corners.size(); k += step) {
    const std::uint32_t d = corners[k];
    if (std::abs(static_cast<double>(normal.dot(cloud.points[d] - origin))) > 2 * wish.coplanarity_m) continue;
    if (!side_fits(cloud, t.a, d, wish.width_m) || !side_fits(cloud, t.b, d, wish.width_m) ||
        !side_fits(cloud, t.c, d, wish.width_m))
      continue;
    const auto base = base_of(cloud.points, {t.a, t.b, t.c, d});
    if (!base || base->gap_m > wish.coplanarity_m) continue;
    const double worth = area_of(*base) * (kFlatWeight + spread(cloud, base->points));
    if (worth > best_worth) best = base, best_worth = worth;
  }
  return best;
}

std::optional<Base> drawn_from(const LocalCloud& source, const Corners& corners, const BaseWish& wish, Rng& rng) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Triangle triangle = draw_triangle(source, corners, wish.width_m, rng);
    if (!(triangle.worth > 0)) continue;
    if (const auto base = with_fourth_corner(source, corners, triangle, wish, rng)) return base;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Base> base_of(std::span<const Eigen::Vector3f> points, const Quad& q) {
  std::optional<Base> best;
  for (const Quad& pairing : {q, Quad{q[0], q[2], q[1], q[3]}, Quad{q[0], q[3], q[1], q[2]}}) {
    const auto base = crossing(points, pairing);
    if (base && (!best || base->gap_m < best->gap_m)) best = base;
  }
  return best;
}

std::optional<Base> select_base(const LocalCloud& source, const BaseWish& wish, Rng& rng) {
  if (source.points.size() < 4 || !(wish.width_m > 0)) return std::nullopt;
  if (wish.at_boundary && source.boundary.size() >= 4)
    if (const auto base = drawn_from(source, Corners(source.boundary), wish, rng)) return base;
  return drawn_from(source, Corners(source.points.size()), wish, rng);
}

}  // namespace isthmus::congruent
