#include "pipelines/view_clouds.h"

#include <algorithm>

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kMostPoints = 900'000;       // 12 bytes each in base64: with the script below 12 MB
constexpr std::size_t kMostPointsOfScan = 40'000;  // of a screen's two million pixels
constexpr std::uint64_t kBytesOfPoint = 12, kBytesOfScript = 700'000;

std::size_t points_of_each(std::size_t num_scans) {
  return num_scans == 0 ? 0 : std::min(kMostPointsOfScan, kMostPoints / num_scans);
}

}  // namespace

std::map<int, ViewKeys> view_keys(const SurveyOutcome& outcome) {
  std::map<int, ViewKeys> keys;
  for (const ScanOutcome& scan : outcome.scans) {
    if (scan.summary && !scan.error) keys[scan.id] = {scan.sampled, scan.intensity};
  }
  return keys;
}

void add_view_clouds(const std::map<int, ViewKeys>& keys, const store::Store& store, report::SurveyRecord& record) {
  const auto is_placed = [](const report::ScanRecord& scan) { return scan.status == report::ScanStatus::placed; };
  const auto num_placed = static_cast<std::size_t>(std::ranges::count_if(record.scans, is_placed));
  for (report::ScanRecord& scan : record.scans) {
    const auto key = keys.find(scan.id);
    if (!is_placed(scan) || key == keys.end()) continue;
    const std::optional<SampledScan> sampled = store.load<SampledScan>(key->second.sampled);
    if (!sampled) continue;
    const Transform& pose = record.solution.find(scan.id)->component_from_local;
    const auto intensity = store.load<std::vector<float>>(key->second.intensity).value_or(std::vector<float>());
    scan.view = report::view_cloud(*sampled, intensity, pose, points_of_each(num_placed));
  }
}

std::uint64_t bytes_of_view(std::size_t num_scans) {
  return kBytesOfScript + kBytesOfPoint * num_scans * points_of_each(num_scans);
}

}  // namespace isthmus::pipelines
