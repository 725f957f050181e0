#include "survey/unit_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace isthmus {
namespace {

constexpr double kGap = 5;           // nothing between two neighbouring sizes: another kind of number, not another room
constexpr double kLeastClear = 500;  // no two stations of one survey differ so much: a thousandfold within a factor 2
constexpr double kMostClear = 2000;  // likewise above
constexpr double kLeastFactor = 25;  // inches (39.37) within a factor 1.6
constexpr double kFarthest_m = 1000;  // diagonal of the inner 90 %: beyond what terrestrial scanners reach

struct Unit {
  const char* name;
  double per_metre;
};
constexpr std::array<Unit, 3> kUnits = {{{"inches", 39.37}, {"centimetres", 100}, {"millimetres", 1000}}};

const Unit& nearest_unit(double factor) {
  const auto distance = [factor](const Unit& unit) { return std::abs(std::log(factor / unit.per_metre)); };
  return *std::ranges::min_element(kUnits, {}, distance);
}

std::string number(double value) { return value < 1000 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value); }

/// Lowest and highest size reached from the median without crossing a gap.
std::pair<double, double> range_around(const std::vector<double>& sorted, std::size_t middle) {
  std::size_t low = middle, high = middle;
  while (low > 0 && sorted[low] <= kGap * sorted[low - 1]) --low;
  while (high + 1 < sorted.size() && sorted[high + 1] <= kGap * sorted[high]) ++high;
  return {sorted[low], sorted[high]};
}

}  // namespace

std::string UnitSuspicion::text() const {
  return fmt::format("its extent is {}, the median of the scans {}: it looks like {} among {}", number(extent),
                     number(median_extent), unit, survey_unit);
}

std::vector<std::optional<UnitSuspicion>> suspect_units(std::span<const double> extents) {
  std::vector<std::optional<UnitSuspicion>> suspicions(extents.size());
  if (extents.size() < 2) return suspicions;
  std::vector<double> sorted(extents.begin(), extents.end());
  std::ranges::sort(sorted);
  const std::size_t middle = (sorted.size() - 1) / 2;
  const double median = sorted[middle];
  const auto [low, high] = range_around(sorted, middle);
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (extents[i] >= low && extents[i] <= high) continue;
    const double larger = std::max(extents[i], median), factor = larger / std::min(extents[i], median);
    const bool clear = factor >= kLeastClear && factor <= kMostClear;
    if (!clear && (factor < kLeastFactor || larger <= kFarthest_m)) continue;
    const char* const fine = nearest_unit(factor).name;
    const bool scan_is_fine = extents[i] > median;
    suspicions[i] = {extents[i], median, scan_is_fine ? fine : "metres", scan_is_fine ? "metres" : fine};
  }
  return suspicions;
}

}  // namespace isthmus
