#include "pipelines/view_clouds.h"

#include <fmt/format.h>

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

void go_without_view(const std::string& reason, const Events& events, report::SurveyRecord& record) {
  record.no_view = reason;
  events.info("report.html does not show the scans in space: " + reason);
}

void add_view_clouds(std::span<const ViewKeys> keys, const store::Store& store, const Events& events,
                     report::SurveyRecord& record) {
  const auto is_placed = [](const report::ScanRecord& scan) { return scan.status == report::ScanStatus::placed; };
  const auto num_placed = static_cast<std::size_t>(std::ranges::count_if(record.scans, is_placed));
  std::size_t num_without = 0;
  for (report::ScanRecord& scan : record.scans) {
    if (!is_placed(scan)) continue;
    const auto key = std::ranges::find(keys, scan.id, &ViewKeys::id);
    const std::optional<SampledScan> sampled = key == keys.end() ? std::nullopt : store.load<SampledScan>(key->sampled);
    if (!sampled) {
      ++num_without;
      continue;
    }
    const Transform& pose = record.solution.find(scan.id)->component_from_local;
    const auto intensity = store.load<std::vector<float>>(key->intensity).value_or(std::vector<float>());
    scan.view = report::view_cloud(*sampled, intensity, pose, points_of_each(num_placed));
  }
  if (num_without == 0) return;
  if (num_without == num_placed) {
    go_without_view("the store does not hold their sampled points; 'isthmus register' makes them again", events,
                    record);
    return;
  }
  events.info(fmt::format("{} of {} scans have no points in the view of report.html: the store does not hold them",
                          num_without, num_placed));
}

std::uint64_t bytes_of_view(std::size_t num_scans) {
  return kBytesOfScript + kBytesOfPoint * num_scans * points_of_each(num_scans);
}

}  // namespace isthmus::pipelines
