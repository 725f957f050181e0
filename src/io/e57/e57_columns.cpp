#include "io/e57/e57_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace isthmus::io {
namespace {

constexpr double kByte = 255.0;
constexpr double kTwoBytes = 65535.0;

std::uint8_t colour_byte(double value, const std::pair<double, double>& limits) {
  const double scaled = (value - limits.first) / (limits.second - limits.first) * kByte;
  return static_cast<std::uint8_t>(scaled >= 0.0 ? std::min(scaled + 0.5, kByte) : 0.0);  // NaN becomes 0
}

std::optional<std::size_t> place_of(const E57Scan& scan, std::string_view name) {
  const auto found = std::find_if(scan.fields.begin(), scan.fields.end(), [&](const E57Field& field) {
    return field.name == name && field.kind != E57FieldKind::other;
  });
  if (found == scan.fields.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scan.fields.begin());
}

bool has_all(const E57Scan& scan, const std::array<const char*, 3>& names) {
  return std::all_of(names.begin(), names.end(), [&](const char* name) { return place_of(scan, name).has_value(); });
}

constexpr std::array<const char*, 3> kCartesian = {"cartesianX", "cartesianY", "cartesianZ"};
constexpr std::array<const char*, 3> kSpherical = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr std::array<const char*, 3> kColour = {"colorRed", "colorGreen", "colorBlue"};

// The bounds of an integer field of up to 16 bits say what its values are scaled to; wider ones are mere defaults.
E57Limits bounds_of(const E57Field& field) {
  if (field.kind != E57FieldKind::integer || field.bits == 0 || field.bits >= 16) return std::nullopt;
  return std::minmax(static_cast<double>(field.minimum) * field.scale + field.offset,
                     static_cast<double>(field.maximum) * field.scale + field.offset);
}

}  // namespace

Result<E57Columns> E57Columns::of(const E57Scan& scan, const E57Section& section, const std::string& where) {
  E57Columns columns;
  const auto add = [&](std::size_t slot, const char* name) {
    if (const auto place = place_of(scan, name)) columns.streams_[slot].emplace(scan.fields[*place], *place, section);
  };
  columns.spherical_ = !has_all(scan, kCartesian);
  if (columns.spherical_ && !has_all(scan, kSpherical)) {
    return fail("its points have neither cartesianX, Y, Z nor sphericalRange, Azimuth, Elevation", where);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) add(kX + axis, (columns.spherical_ ? kSpherical : kCartesian)[axis]);
  add(kInvalid, columns.spherical_ ? "sphericalInvalidState" : "cartesianInvalidState");
  add(kIntensity, "intensity");
  if (columns.has_intensity()) add(kNoIntensity, "isIntensityInvalid");
  if (!has_all(scan, kColour)) return columns;
  for (std::size_t c = 0; c < 3; ++c) {
    add(kRed + c, kColour[c]);
    const E57Field& field = scan.fields[*place_of(scan, kColour[c])];
    columns.colour_limits_[c] = scan.colour_limits[c] ? scan.colour_limits[c] : bounds_of(field);
    columns.float_colour_ |= field.kind != E57FieldKind::integer;
  }
  return columns;
}

Result<void> E57Columns::read(E57Packets& packets, std::size_t n) {
  for (std::size_t slot = 0; slot < kNumSlots; ++slot) {
    if (!streams_[slot]) continue;
    values_[slot].resize(n);
    if (auto read = streams_[slot]->read(packets, n, values_[slot].data()); !read) return read;
  }
  size_ = n;
  return {};
}

Eigen::Vector3d E57Columns::position(std::size_t i) const {
  const Eigen::Vector3d stored(values_[kX][i], values_[kY][i], values_[kZ][i]);
  if (!spherical_) return stored;
  const double range = stored[0], azimuth = stored[1], elevation = stored[2];
  return {range * std::cos(elevation) * std::cos(azimuth), range * std::cos(elevation) * std::sin(azimuth),
          range * std::sin(elevation)};
}

void E57Columns::append(std::size_t i, const Eigen::Vector3d& origin, PointChunk& chunk) const {
  chunk.points.emplace_back((position(i) - origin).cast<float>());
  if (has_intensity()) {
    const bool known = !streams_[kNoIntensity] || values_[kNoIntensity][i] == 0.0;
    chunk.intensity.push_back(known ? static_cast<float>(values_[kIntensity][i])
                                    : std::numeric_limits<float>::quiet_NaN());
  }
  if (!has_colour()) return;
  std::array<std::uint8_t, 3> colour = {};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = colour_byte(values_[kRed + c][i], *colour_limits_[c]);
  chunk.colour.push_back(colour);
}

double E57Columns::largest_colour() const {
  double largest = 0.0;
  for (std::size_t slot = kRed; slot <= kBlue; ++slot) {
    for (std::size_t i = 0; i < std::min(size_, values_[slot].size()); ++i) {
      largest = std::max(largest, values_[slot][i]);
    }
  }
  return largest;
}

void E57Columns::choose_colour_scale(double largest) {
  const double high = float_colour_ && largest <= 1.0 ? 1.0 : largest <= kByte ? kByte : kTwoBytes;
  for (E57Limits& limits : colour_limits_) {
    if (!limits) limits = std::pair(0.0, high);
  }
}

}  // namespace isthmus::io
