// The points of the placed scans for the report's 3D view, from the store.
#pragma once

#include <span>

#include "pipelines/events.h"
#include "pipelines/measured_survey.h"
#include "report/survey_record.h"
#include "store/store.h"

namespace isthmus::pipelines {

/// Fills ScanRecord::view of the placed scans, one scan in memory at a time; all clouds together stay below 11 MB of
/// the page. A scan whose sampling is not in the store has none: the page shows its station without points. How many
/// lack them is told; where all do, the record says why there is no view.
void add_view_clouds(std::span<const ViewKeys> keys, const store::Store& store, const Events& events,
                     report::SurveyRecord& record);

/// Tells why the report has no view, and has it say so.
void go_without_view(const std::string& reason, const Events& events, report::SurveyRecord& record);

/// At most, in the page, for so many scans. Where the disk has no such space the report goes without.
std::uint64_t bytes_of_view(std::size_t num_scans);
inline constexpr const char* kNoSpaceForView = "the disk has no space for them";

}  // namespace isthmus::pipelines
