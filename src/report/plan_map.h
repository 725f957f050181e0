// The plan map: stations and links of one component as SVG.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// Stations seen from above (or on the plane in which they spread most, when they are not level), footprints as faint
/// discs, links coloured by probability or residual, dashed when ambiguous. `large` for the main map, small ones for
/// lesser components.
std::string plan_map_svg(const SurveyRecord& record, int component, bool large);

/// Where the map puts a placed scan, and which way is up on it (out of the sheet), in the component's frame.
Eigen::Vector3d station_in_component(const SurveyRecord& record, const ScanRecord& scan);
Eigen::Vector3d up_of_plan(const SurveyRecord& record, int component);

/// Legend and switches that belong to all maps.
std::string plan_map_legend();

}  // namespace isthmus::report
