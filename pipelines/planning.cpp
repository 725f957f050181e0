#include "pipelines/planning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <oneapi/tbb/task_arena.h>

#include "base/parallel.h"
#include "pipelines/code_versions.h"
#include "pipelines/scan_positions.h"
#include "store/content_digest.h"
#include "survey/unit_check.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kChunkPoints = std::size_t{1} << 16;
// 2.4 MB a thread, beside up to 128 MB while floating points are looked for; enough for a voxel good to a few per cent.
constexpr std::size_t kProbePoints = 200000;
constexpr double kFixedBytes = 64e6;  // chunk, probe, descriptors and regions, whatever the number of voxels
constexpr double kBytesPerVoxel =
    600;  // accumulator, sampled point, normals' and descriptors' neighbourhoods (measured)
constexpr double kLeastBytesPerPoint = 6;  // three 16-bit coordinates: no format stores a point in less

/// ScanScale as the store keeps it: voxel, spacing, extent.
using StoredScale = std::array<double, 3>;

struct Look {
  std::string content;
  store::FileIdentity identity{};
  std::optional<ScanScale> scale;
  std::optional<Error> error;
  bool unseen = false;
};

Result<ScanScale> measure_scale(const io::ScanRef& ref, int target_points) {
  const Result<std::unique_ptr<io::ScanReader>> reader = io::open_scan(ref);
  if (!reader) return tl::unexpected(reader.error());
  const Result<PointChunk> probe = io::probe_scan(ref, kProbePoints);
  if (!probe) return tl::unexpected(probe.error());
  Result<ScanScale> scale = scale_of_probe(*probe, (*reader)->header().num_points, target_points);
  if (!scale && scale.error().where.empty()) scale.error().where = ref.name;
  return scale;
}

Look look_at(const io::ScanRef& ref, const Settings& settings, const store::Store& store) {
  Look look;
  if (const Result<store::FileIdentity> identity = store::identity_of(ref.path)) look.identity = *identity;
  Result<std::string> content = store::content_digest(ref.path, store);
  if (!content) {
    look.error = content.error();
    return look;
  }
  look.content = *content;
  const std::array<std::string, 3> inputs = {*content, std::to_string(ref.index),
                                             std::to_string(settings.sampling.target_points)};
  const store::Key key = store::make_key("scale", kSampledVersion, inputs);
  if (const auto known = store.load<StoredScale>(key)) {
    look.scale = ScanScale{(*known)[0], (*known)[1], (*known)[2]};
    return look;
  }
  const Result<ScanScale> scale = measure_scale(ref, settings.sampling.target_points);
  if (!scale) {
    look.error = scale.error();
    return look;
  }
  look.scale = *scale;
  store.keep(key, StoredScale{scale->voxel_m, scale->spacing_m, scale->extent_m});
  return look;
}

/// A scan that another process is to look at, as far as it did.
Look look_from_afar(const io::ScanRef& ref, const Settings& settings, const store::Store& store, const Share& share) {
  const Result<std::optional<std::string>> content = store::remembered_digest(ref.path, store);
  if (content && *content) return look_at(ref, settings, store);
  Look look;
  look.unseen = content.has_value();
  if (!content) look.error = content.error();
  if (!look.unseen || !share.only_looks()) return look;
  const Result<ScanScale> scale = measure_scale(ref, settings.sampling.target_points);
  if (scale) look.scale = *scale;
  if (!scale) look.error = scale.error();
  return look;
}

/// What is wrong with a scan, its content read to the end.
std::optional<Error> trouble_of(const io::ScanRef& ref, const Settings& settings, const store::Store& store) {
  const Look look = look_at(ref, settings, store);
  if (look.error) return look.error;
  const store::Key key =
      store::make_key("readable", kSampledVersion, std::array<std::string, 2>{look.content, std::to_string(ref.index)});
  if (store.load<std::uint64_t>(key)) return std::nullopt;
  Result<std::unique_ptr<io::ScanReader>> reader = io::open_scan(ref);
  if (!reader) return reader.error();
  std::uint64_t num_points = 0;
  for (PointChunk chunk;;) {
    if (Result<void> done = (*reader)->read(chunk, kChunkPoints); !done) return done.error();
    if (chunk.points.empty()) break;
    num_points += chunk.points.size();
  }
  store.keep(key, num_points);
  return std::nullopt;
}

/// Moves scans that seem to be in another unit from `looks` to the errors, so that they decide neither the voxel nor
/// any pose.
std::vector<bool> mark_other_units(const std::vector<io::ListedScan>& scans, std::vector<Look>& looks) {
  std::vector<bool> marked(looks.size(), false);
  std::vector<double> extents;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (!looks[i].scale) continue;
    extents.push_back(looks[i].scale->extent_m);
    index.push_back(i);
  }
  const auto suspicions = suspect_units(extents);
  for (std::size_t k = 0; k < suspicions.size(); ++k) {
    if (!suspicions[k]) continue;
    looks[index[k]].error =
        Error{suspicions[k]->text(), scans[index[k]].scan.name,
              "convert it to the others' unit; if its size is right, set candidates.check_units=false"};
    looks[index[k]].scale.reset();
    marked[index[k]] = true;
  }
  return marked;
}

/// Memory that making a scan's products takes: surfaces have a number of voxels that falls with the square of their
/// size.
std::size_t bytes_to_make(const io::ScanRef& ref, const ScanScale& scale, double voxel_m, int target_points) {
  const double ratio = scale.voxel_m / voxel_m;
  double voxels = target_points * ratio * ratio;
  std::error_code error;
  const auto file_bytes = static_cast<double>(std::filesystem::file_size(ref.path, error));
  if (!error) voxels = std::min(voxels, file_bytes / kLeastBytesPerPoint);
  return static_cast<std::size_t>(kFixedBytes + kBytesPerVoxel * voxels);
}

/// The file was in order when the run began; what has become of it since is only worth a warning.
ScanPositions given_stations(const std::vector<io::ListedScan>& scans, const Settings& settings) {
  std::vector<std::string> names;
  for (const io::ListedScan& scan : scans) names.push_back(scan.scan.name);
  Result<ScanPositions> stations = read_stations(settings.sampling.stations, names);
  return stations ? std::move(*stations) : ScanPositions{{}, {stations.error().text()}};
}

}  // namespace

SurveyPlan plan_survey(const std::vector<io::ListedScan>& scans, const Settings& settings, const store::Store& store,
                       const Events& events, const std::atomic<bool>& stop, const Share& share) {
  std::vector<Look> looks(scans.size());
  std::atomic<std::size_t> done{0};
  parallel_for_index(scans.size(), 1, [&](std::size_t i) {
    if (scans[i].error) {
      looks[i].error = scans[i].error;
    } else if (!stop) {
      looks[i] = share.has(i) ? look_at(scans[i].scan, settings, store)
                              : look_from_afar(scans[i].scan, settings, store, share);
    }
    events.advance("look", done.fetch_add(1) + 1, scans.size());
  });
  SurveyPlan plan;
  if (stop) return plan;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (looks[i].unseen && !looks[i].error) plan.unseen.push_back(static_cast<int>(i));
  }
  if (!plan.unseen.empty() && !share.only_looks()) return plan;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (looks[i].error) looks[i].error = by_name(*looks[i].error, scans[i].scan);
  }
  std::vector<bool> other_unit(scans.size(), false);
  if (settings.candidates.check_units) other_unit = mark_other_units(scans, looks);
  std::vector<ScanScale> scales;
  for (const Look& look : looks) {
    if (look.scale) scales.push_back(*look.scale);
  }
  plan.automatic_voxel = !settings.sampling.voxel_m;
  if (settings.sampling.voxel_m) {
    plan.voxel_m = *settings.sampling.voxel_m;
  } else if (!scales.empty()) {
    plan.voxel_m = automatic_voxel_m(scales);
  }
  const SettingsDigests digests = digests_of(settings);
  ScanPositions stations = given_stations(scans, settings);
  plan.warnings = std::move(stations.warnings);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const int id = static_cast<int>(i);
    if (looks[i].error) {
      plan.failed.push_back({id, *looks[i].error, other_unit[i]});
      continue;
    }
    if (looks[i].unseen) continue;
    const auto station = stations.by_name.find(scans[i].scan.name);
    plan.scans.push_back(make_plan(id, scans[i].scan, looks[i].content, plan.voxel_m,
                                   station != stations.by_name.end() ? std::optional(station->second) : std::nullopt,
                                   digests));
    plan.scans.back().identity = looks[i].identity;
    plan.scans.back().bytes =
        bytes_to_make(scans[i].scan, *looks[i].scale, plan.voxel_m, settings.sampling.target_points);
  }
  return plan;
}

void take_readable_twins(io::ScanListing& listing, const Settings& settings, const store::Store& store,
                         const std::atomic<bool>& stop) {
  oneapi::tbb::task_arena arena(threads_of(settings.run));
  arena.execute([&] {
    io::take_readable_twins(listing, [&](const io::ScanRef& scan) -> std::optional<Error> {
      if (stop) return std::nullopt;
      return trouble_of(scan, settings, store);
    });
  });
}

}  // namespace isthmus::pipelines
