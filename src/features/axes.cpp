#include "features/axes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

constexpr int kDirections = 2500;        // on a half sphere: about 3 degrees apart
constexpr float kFlatVariation = 0.03f;  // rougher surroundings have no normal worth a vote
constexpr float kWindowRad = 6.0f * std::numbers::pi_v<float> / 180;
constexpr double kMinParallelShare = 0.04;
constexpr double kMinPerpendicularGain = 3;   // times even scatter: trunks and poles over ground too rough for a plane
constexpr double kMinShareOfFirst = 0.5;      // weaker ones beside a strong axis are chance
constexpr double kPerpendicularWeight = 0.5;  // walls of any heading are across: they tell less than a floor

struct Counts {
  double parallel = 0, perpendicular = 0;
};

Counts count(std::span<const Eigen::Vector3f> normals, const Eigen::Vector3f& d, float window_rad) {
  const float near_one = std::cos(window_rad), near_zero = std::sin(window_rad);
  std::size_t parallel = 0, perpendicular = 0;
  for (const auto& n : normals) {
    const float c = std::abs(n.dot(d));
    parallel += c > near_one;
    perpendicular += c < near_zero;
  }
  const auto total = static_cast<double>(normals.size());
  return {static_cast<double>(parallel) / total, static_cast<double>(perpendicular) / total};
}

// How many more normals lie along and across d than in even scatter.
double score(const Counts& c, float window_rad) {
  return c.parallel - (1 - std::cos(window_rad)) + kPerpendicularWeight * (c.perpendicular - std::sin(window_rad));
}

// Do the normals across d look all round, as those of trunks, and not one way, as those of a plane?
bool look_round(std::span<const Eigen::Vector3f> normals, const Eigen::Vector3f& d) {
  constexpr float kLeastOfTrace = 0.15f;
  Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
  for (const auto& n : normals)
    if (std::abs(n.dot(d)) < std::sin(kWindowRad)) scatter += n * n.transpose();
  const Eigen::Vector3f values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(scatter, Eigen::EigenvaluesOnly).eigenvalues();
  return values[1] > kLeastOfTrace * values.sum();  // values[0] belongs to d itself
}

// Enough normals along d (floors, walls), or far more across it, all round, than even scatter has.
bool organises(std::span<const Eigen::Vector3f> normals, const Eigen::Vector3f& d, const Counts& c,
               double share_of_least) {
  const double even_parallel = 1 - std::cos(kWindowRad), even_across = std::sin(kWindowRad);
  if (c.parallel >= share_of_least * std::max(kMinParallelShare, 2 * even_parallel)) return true;
  return c.perpendicular >= share_of_least * kMinPerpendicularGain * even_across && look_round(normals, d);
}

// Least squares: normals along d vote for it, normals across vote against their own direction.
Eigen::Vector3f refined(std::span<const Eigen::Vector3f> normals, Eigen::Vector3f d) {
  for (const float window : {kWindowRad, 0.7f * kWindowRad, 0.5f * kWindowRad, 0.5f * kWindowRad}) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    for (const auto& n : normals) {
      const float c = std::abs(n.dot(d));
      if (c > std::cos(window)) m += (n * n.transpose()).cast<double>();
      if (c < std::sin(window)) m -= (n * n.transpose()).cast<double>();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
    const Eigen::Vector3f next = solver.eigenvectors().col(2).cast<float>();
    d = next.dot(d) < 0 ? Eigen::Vector3f(-next) : next;
  }
  return d.normalized();
}

DominantAxis described(std::span<const Eigen::Vector3f> normals, Eigen::Vector3f d) {
  const float window = 0.5f * kWindowRad;
  double along = 0, sq_sum = 0;
  std::size_t n = 0;
  for (const auto& normal : normals) {
    const float c = normal.dot(d);
    if (std::abs(c) > std::cos(window)) {
      along += c > 0 ? 1 : -1;
      sq_sum += std::max(0.0, 1.0 - static_cast<double>(c) * c);
      ++n;
    }
  }
  DominantAxis axis;
  axis.direction = along < 0 ? Eigen::Vector3f(-d) : d;
  const Counts c = count(normals, d, kWindowRad);
  axis.weight = static_cast<float>(c.parallel + c.perpendicular);
  axis.sign_agreement = n ? static_cast<float>(std::abs(along) / static_cast<double>(n)) : 0.0f;
  // Two tangent directions share the squared deviation; neighbouring normals are not independent (about 20 to a patch).
  constexpr double kPatch = 20;
  axis.sigma_rad = n ? static_cast<float>(std::sqrt(sq_sum / 2 / static_cast<double>(n) /
                                                    std::max(1.0, static_cast<double>(n) / kPatch)))
                     : 1.0f;
  return axis;
}

}  // namespace

std::vector<DominantAxis> dominant_axes(std::span<const Eigen::Vector3f> normals, std::span<const float> variation,
                                        std::size_t max_axes) {
  std::vector<Eigen::Vector3f> flat;
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (variation[i] < kFlatVariation) flat.push_back(normals[i]);
  constexpr std::size_t kMinFlat = 50;
  if (flat.size() < kMinFlat) return {};
  std::vector<Eigen::Vector3f> thinned;  // 4000 normals decide as well as 40,000
  const std::size_t stride = std::max<std::size_t>(1, flat.size() / 4000);
  for (std::size_t i = 0; i < flat.size(); i += stride) thinned.push_back(flat[i]);

  std::vector<std::pair<double, Eigen::Vector3f>> scored;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < kDirections; ++k) {  // Fibonacci half sphere
    const double z = (k + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const Eigen::Vector3f d(static_cast<float>(r * std::cos(golden * k)), static_cast<float>(r * std::sin(golden * k)),
                            static_cast<float>(z));
    const Counts c = count(thinned, d, kWindowRad);
    if (!organises(thinned, d, c, 0.5)) continue;
    scored.emplace_back(score(c, kWindowRad), d);
  }
  std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first > b.first; });

  std::vector<DominantAxis> axes;
  const float apart = std::cos(30.0f * std::numbers::pi_v<float> / 180);
  for (const auto& [value, direction] : scored) {
    const auto taken = [&](const Eigen::Vector3f& d) {
      return std::any_of(axes.begin(), axes.end(),
                         [&](const DominantAxis& a) { return std::abs(a.direction.dot(d)) > apart; });
    };
    if (taken(direction)) continue;
    const Eigen::Vector3f d = refined(flat, direction);
    const Counts c = count(flat, d, kWindowRad);
    if (!organises(flat, d, c, 1) || taken(d)) continue;
    axes.push_back(described(flat, d));
    if (axes.size() == max_axes) break;
  }
  std::stable_sort(axes.begin(), axes.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  while (axes.size() > 1 && axes.back().weight < kMinShareOfFirst * axes.front().weight) axes.pop_back();
  return axes;
}

}  // namespace isthmus
