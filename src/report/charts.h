// The pair matrix, histograms and stage times as SVG and HTML.
#pragma once

#include <array>
#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

inline constexpr int kNumBins = 10;
struct VerdictBins {
  std::array<std::array<int, 3>, kNumBins> counts{};  ///< accepted, ambiguous, rejected
};
/// Of pairs with a transform: overlap in tenths; residual in tenths of a voxel, the last bin with all beyond.
VerdictBins overlap_bins(const SurveyRecord& record);
VerdictBins residual_bins(const SurveyRecord& record);
/// Of links with a loop (loop_closures.h): where it misses, in tenths of a voxel, the last bin with all beyond.
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
