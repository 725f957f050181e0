// The pair matrix, histograms and stage times as SVG and HTML.
#pragma once

#include <array>
#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

inline constexpr int kNumBins = 10;
struct VerdictBins {
  std::array<std::array<int, 3>, kNumBins> counts{};  ///< accepted, ambiguous, rejected
  double bin_width = 1.0 / kNumBins;
};
/// Of pairs with a transform: overlap in tenths; residual in metres. The last bin holds all beyond; bins of lengths are
/// as wide (1, 2 or 5 times a power of ten) as it takes for the accepted links to be told apart.
VerdictBins overlap_bins(const SurveyRecord& record);
VerdictBins residual_bins(const SurveyRecord& record);
/// Of links with a loop (loop_closures.h): by how much it misses, metres.
VerdictBins loop_bins(const SurveyRecord& record);

Seconds seconds_by_stage(const SurveyRecord& record);  ///< summed over scans and pairs

/// A square per pair, scans ordered by component: below the diagonal the verdict, above it the overlap.
std::string pair_matrix(const SurveyRecord& record);

std::string overlap_histogram(const SurveyRecord& record);
std::string residual_histogram(const SurveyRecord& record);
std::string loop_histogram(const SurveyRecord& record);

/// Seconds by stage, summed over scans and pairs.
std::string stage_times(const SurveyRecord& record);

}  // namespace isthmus::report
