// Extents of all scans -> which of them look as if they were written in another unit than the rest.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isthmus {

/// Why a scan is suspected.
struct UnitSuspicion {
  double extent = 0;         ///< of the scan, in its own unit
  double median_extent = 0;  ///< of all scans (the lower of the two middle ones)
  std::string unit;          ///< "millimetres", what the scan seems to be in, taking the rest for `survey_unit`
  std::string survey_unit;   ///< "metres"

  /// "its extent is 24310, the median of the scans 25.2: it looks like millimetres among metres"
  [[nodiscard]] std::string text() const;
};

/// One answer a scan; `extents` are robust diagonals, > 0. Scans of one survey differ tenfold without anything being
/// wrong (a cupboard in a hall), so a scan is suspected only if (1) a gap of more than a factor 5 without any scan in
/// it lies between it and the scans around the median, and (2) it is 500 to 2000 times as large or small as the median,
/// or at least 25 times with the larger of the two above 1000, where no scanner measures in metres. Feet among metres
/// (3.3) cannot be told from sizes. Any order of the scans gives the same answers.
std::vector<std::optional<UnitSuspicion>> suspect_units(std::span<const double> extents);

}  // namespace isthmus
