// Pieces that every part of the page uses: escaping, numbers for people, the colour classes of links.
#pragma once

#include <string>
#include <string_view>

#include "report/survey_record.h"

namespace isthmus::report {

std::string escaped(std::string_view text);

std::string metres(double value);           ///< "0.42 mm", "12 mm", "1.25 m"
std::string degrees(double radians);        ///< "0.04°"
std::string percent(double share);          ///< "31 %"
std::string large_number(std::uint64_t n);  ///< "1.25 million"
std::string duration(double seconds);       ///< "3 min 20 s"

/// "3 scans", "1 scan"
std::string counted(int n, std::string_view noun);

/// Short name for maps: the last path component without extension, shortened in the middle to `max_length` characters.
std::string short_name(const std::string& name, std::size_t max_length);

inline constexpr int kNumClasses = 5;
/// 0 = best. Bounds shown in the legend.
int probability_class(double probability);
int residual_class(double rms_m, double voxel_m);
const char* probability_bound(int c);
const char* residual_bound(int c);

/// Text of a link's tooltip.
std::string link_title(const SurveyRecord& record, const SolvedLink& link);

}  // namespace isthmus::report
