// What run.json and report.json have in common. For sources only: it brings the whole of the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "report/run_json.h"

namespace isthmus::report {

using Json = nlohmann::ordered_json;

Json counts_json(const SurveyCounts& counts);
Json versions_json(const SurveyRecord& record);
Json warnings_json(const SurveyRecord& record);  ///< those that every run with the same input has
/// `frame` and `datum_shift_m` where control lays the component into a frame.
void add_frame(const Component& component, Json& to);
Json edits_json(const SurveyRecord& record);    ///< links taken out or added by hand
Json control_json(const SurveyRecord& record);  ///< how each item of the control fits
Json run_section(const RunRecord& run);

/// Indented. Broken UTF-8 (file names may hold any byte) is replaced, which keeps the file readable.
std::string text_of(const Json& json);

}  // namespace isthmus::report
