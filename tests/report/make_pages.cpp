// Writes made-up reports with clouds for the test in a browser, and the last one's poses for the test with Open3D:
// report_pages FOLDER NUM_STATIONS...
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/atomic_file.h"
#include "report/html_report.h"
#include "report/pose_exports.h"
#include "report/sample_clouds.h"
#include "report/write_outputs.h"

namespace {

using namespace isthmus;

Result<void> write_page(const std::filesystem::path& folder, int num_scans) {
  constexpr std::size_t kMostPoints = 900'000, kMostPointsOfScan = 40'000;
  report::SurveyRecord record = testing::sample_record(num_scans);
  testing::add_sample_clouds(record, std::min(kMostPointsOfScan, kMostPoints / static_cast<std::size_t>(num_scans)));
  const auto page = folder / fmt::format("stations_{}.html", num_scans);
  if (auto written = write_file_atomically(page, report::html_report(record)); !written) return written;
  if (auto written = report::write_outputs(record, folder / "out"); !written) return written;
  const auto survey = report::read_finished_survey(folder / "out");
  if (!survey) return tl::unexpected(survey.error());
  for (const auto& [name, format] :
       {std::pair("graph.json", report::PoseFormat::open3d), std::pair("poses.csv", report::PoseFormat::csv)}) {
    auto written = write_file_atomically(folder / name, report::export_poses(*survey, 0, format));
    if (!written) return written;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  for (int k = 2; k < argc; ++k) {
    const auto written = write_page(folder, std::max(4, std::atoi(argv[k])));
    if (written) continue;
    fmt::print(stderr, "{}\n", written.error().text());
    return 1;
  }
  return 0;
}
