#include "report/write_outputs.h"

#include <functional>
#include <string>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "report/html_report.h"
#include "report/pose_files.h"
#include "report/report_json.h"
#include "report/run_json.h"
#include "report/tables.h"

namespace isthmus::report {

Result<void> write_outputs(const SurveyRecord& record, const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code)
    return fail("cannot create the folder: " + code.message(), folder.string(), "check permissions and free space");
  const std::pair<const char*, std::string (*)(const SurveyRecord&)> files[] = {{"scans.csv", scans_csv},
                                                                                {"poses.txt", poses_text},
                                                                                {"pose_graph.g2o", pose_graph_g2o},
                                                                                {"links.csv", links_csv},
                                                                                {"covariances.csv", covariances_csv},
                                                                                {"timings.csv", timings_csv},
                                                                                {"report.html", html_report},
                                                                                {"report.json", report_json},
                                                                                {"run.json", run_json}};
  for (const auto& [name, content_of] : files)
    if (Result<void> written = write_file_atomically(folder / name, content_of(record)); !written) return written;
  return {};
}

}  // namespace isthmus::report
