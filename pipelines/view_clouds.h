// The points of the placed scans for the report's 3D view, from the store.
#pragma once

#include <map>

#include "pipelines/survey_pipeline.h"
#include "report/survey_record.h"
#include "store/store.h"

namespace isthmus::pipelines {

struct ViewKeys {
  store::Key sampled, intensity;
};

/// Where the products that make the clouds lie, by id.
std::map<int, ViewKeys> view_keys(const SurveyOutcome& outcome);

/// Fills ScanRecord::view of the placed scans, one scan in memory at a time. A scan whose sampling the store could not
/// keep has none: the page shows its station without points. All clouds together stay below 11 MB of the page.
void add_view_clouds(const std::map<int, ViewKeys>& keys, const store::Store& store, report::SurveyRecord& record);

/// At most, in the page, for so many scans. Where the disk has no such space the report goes without.
std::uint64_t bytes_of_view(std::size_t num_scans);

}  // namespace isthmus::pipelines
