#include "features/upright.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace isthmus {
namespace {

constexpr float kConeRad = 15.0f * std::numbers::pi_v<float> / 180;  // instruments are blind within 20 to 35 degrees
constexpr double kBlindShare = 0.9;                                  // of a cone: without a return
constexpr std::size_t kSectors = 12;                                 // of the horizon
constexpr float kHorizonRad = 25.0f * std::numbers::pi_v<float> / 180;
constexpr double kSectorShare = 0.25;  // of a sector's cells: with a return
constexpr std::size_t kMostDarkSectors = 1;

/// Middle of a cell of the cube map, the inverse of cube_cell(); not of unit length.
Eigen::Vector3f direction_of(std::size_t face, std::size_t row, std::size_t column, std::uint32_t size) {
  const auto at = [size](std::size_t k) { return (2 * static_cast<float>(k) + 1) / static_cast<float>(size) - 1; };
  const float u = at(column), v = at(row), sign = face % 2 == 0 ? 1.0f : -1.0f;
  if (face < 2) return {sign, u, v};
  if (face < 4) return {u, sign, v};
  return {u, v, sign};
}

struct Share {
  std::size_t cells = 0, filled = 0;
  void add(bool is_filled) { ++cells, filled += is_filled ? 1 : 0; }
  [[nodiscard]] double value() const {
    return cells > 0 ? static_cast<double>(filled) / static_cast<double>(cells) : 0.0;
  }
};

/// What the station saw around an axis: returns in the cones about its two ends, and along the horizon between them.
struct View {
  Share along, against;
  std::array<Share, kSectors> horizon;

  [[nodiscard]] bool looks_round() const {
    return static_cast<std::size_t>(std::ranges::count_if(
               horizon, [](const Share& s) { return s.value() < kSectorShare; })) <= kMostDarkSectors;
  }
  [[nodiscard]] bool blind_along() const { return along.value() < 1 - kBlindShare; }
  [[nodiscard]] bool blind_against() const { return against.value() < 1 - kBlindShare; }
};

View view_about(const FreeSpace& image, const Eigen::Vector3f& axis) {
  View view;
  const Eigen::Matrix3f z_from_scan =
      Eigen::Quaternionf::FromTwoVectors(axis, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  const float cone = std::cos(kConeRad), horizon = std::sin(kHorizonRad);
  std::size_t cell = 0;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t row = 0; row < image.size; ++row)
      for (std::size_t column = 0; column < image.size; ++column, ++cell) {
        const Eigen::Vector3f d = z_from_scan * direction_of(face, row, column, image.size).normalized();
        const bool filled = std::isfinite(image.nearest_m[cell]);
        if (d.z() > cone) view.along.add(filled);
        if (d.z() < -cone) view.against.add(filled);
        if (std::abs(d.z()) > horizon) continue;
        const float turn = (std::atan2(d.y(), d.x()) / std::numbers::pi_v<float> + 1) / 2;
        view.horizon[std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors))].add(filled);
      }
  return view;
}

void mark_upright(const FreeSpace& image, DominantAxis& axis) {
  const View view = view_about(image, axis.direction);
  axis.upright = view.looks_round() && (view.blind_along() || view.blind_against());
  if (!axis.upright || view.blind_along() == view.blind_against()) return;  // both: the normals' sign is all there is
  // The blind end is the tripod's, or the sky. Where nothing lies over the station the planes across the axis face up.
  constexpr float kNothingAbove = 0.95f, kMostlyOneWay = 0.5f;
  if (view.blind_along()) {
    if (axis.sign_agreement >= kNothingAbove) return;
    axis.direction = -axis.direction;
    if (axis.sign_agreement >= kMostlyOneWay) {
      axis.sign_agreement = 0;  // floors face the one end, the tripod's shadow lies at the other: either may be up
      return;
    }
  }
  axis.sign_agreement = 1;
}

/// Median distance from the station of the planes across the axis; one much weaker than the strongest is far away.
float distance_of_planes(const SampledScan& scan, const DominantAxis& axis, float strongest) {
  constexpr float kComparable = 0.7f, kAlong = 0.99f;
  if (axis.weight < kComparable * strongest) return std::numeric_limits<float>::infinity();
  std::vector<float> offsets;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (std::abs(scan.normals[i].dot(axis.direction)) > kAlong)
      offsets.push_back(std::abs((scan.points[i] - scan.station).dot(axis.direction)));
  if (offsets.empty()) return std::numeric_limits<float>::infinity();
  std::nth_element(offsets.begin(), offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2), offsets.end());
  return offsets[offsets.size() / 2];
}

}  // namespace

void put_upright_first(const SampledScan& scan, std::vector<DominantAxis>& axes) {
  if (scan.station_kind == StationKind::unknown) return;
  std::vector<std::pair<float, DominantAxis>> ranked;
  const float strongest = axes.empty() ? 0.0f : axes.front().weight;
  for (DominantAxis axis : axes) {
    if (scan.free_space.size > 0) mark_upright(scan.free_space, axis);
    ranked.emplace_back(distance_of_planes(scan, axis, strongest), axis);
  }
  std::ranges::stable_sort(ranked, [](const auto& a, const auto& b) {
    return a.second.upright != b.second.upright ? a.second.upright : a.first < b.first;
  });
  for (std::size_t k = 0; k < axes.size(); ++k) axes[k] = ranked[k].second;
}

}  // namespace isthmus
