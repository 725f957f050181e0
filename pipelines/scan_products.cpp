#include "pipelines/scan_products.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <set>
#include <tuple>

#include "pipelines/code_versions.h"
#include "pipelines/intensity_sampler.h"
#include "scan/station_frame.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kChunkPoints = std::size_t{1}
                                     << 16;   // 1.2 MB with intensity and colour: fits the second-level cache
constexpr const char* kSummaryVersion = "5";  // of summarise() below; what goes into it is in the regions' key
constexpr std::size_t kOutlinePoints = 2000;

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Loads `key` or makes it, and notes the time either way.
template <class T, class Make>
Result<T> load_or_make(const store::Store& store, const store::Key& key, const std::string& name,
                       std::vector<StageTime>& times, const Make& make) {
  const Stopwatch watch;
  if (std::optional<T> found = store.load<T>(key)) {
    times.push_back({key.stage, watch.seconds(), true});
    return std::move(*found);
  }
  store::Store::Work work = store.work(key, name);
  Result<T> made = make();
  times.push_back({key.stage, watch.seconds(), false});
  if (made) {
    store.keep(key, *made);
    work.made();
  } else {
    work.failed(made.error());
  }
  return made;
}

Result<SampledScan> read_and_reduce(const ScanPlan& plan, const SamplingOptions& options, const store::Store& store) {
  Result<std::unique_ptr<io::ScanReader>> reader = io::open_scan(plan.ref);
  if (!reader) return tl::unexpected(reader.error());
  ScanHeader header = (*reader)->header();
  if (plan.station_in_scan) header.station_in_scan = plan.station_in_scan;
  const StationFrame frame(header);
  VoxelSampler sampler(header, plan.voxel_m, options);
  IntensitySampler intensities(plan.voxel_m);
  PointChunk chunk;
  for (;;) {
    if (Result<void> done = (*reader)->read(chunk, kChunkPoints); !done) return tl::unexpected(done.error());
    if (chunk.points.empty()) break;
    frame.move(chunk);
    sampler.add(chunk);
    intensities.add(chunk);
  }
  // What is read now would be kept as what the content of then was reduced to.
  const Result<store::FileIdentity> identity = store::identity_of(plan.ref.path);
  if (!identity) return tl::unexpected(identity.error());
  if (*identity != plan.identity) {
    return fail("it changed while the run was working", plan.ref.name, "run again when it is complete");
  }
  Result<SampledScan> sampled = sampler.finish();
  if (!sampled && sampled.error().where.empty()) sampled.error().where = plan.ref.name;
  if (sampled) {
    store.keep(plan.intensity, intensities.of(*sampled));
    const std::vector<std::string>& read_notes = (*reader)->header().notes;
    sampled->notes.insert(sampled->notes.begin(), read_notes.begin(), read_notes.end());
    if (header.file_from_scan)
      sampled->station_in_file =
          *header.file_from_scan * header.station_in_scan.value_or(Eigen::Vector3d(Eigen::Vector3d::Zero()));
  }
  return sampled;
}

/// One point per occupied cell, the cell doubled until few enough remain.
std::pair<std::vector<Eigen::Vector3f>, float> outline_of(const SampledScan& scan) {
  std::vector<Eigen::Vector3f> points = scan.points;
  auto cell = static_cast<float>(scan.voxel_m);
  while (points.size() > kOutlinePoints) {
    cell *= 2;
    std::set<std::tuple<long, long, long>> seen;
    std::erase_if(points, [&](const Eigen::Vector3f& p) {
      const auto index = [cell](float x) { return static_cast<long>(std::floor(x / cell)); };
      return !seen.emplace(index(p.x()), index(p.y()), index(p.z())).second;
    });
  }
  return {std::move(points), cell};
}

// Rows of unit length and without negative values: a byte a value is enough to say on which side of a plane they lie.
std::vector<std::uint8_t> coarse_descriptors(const FeatureCloud& features) {
  std::vector<std::uint8_t> out(features.descriptors.size());
  std::ranges::transform(features.descriptors, out.begin(), [](float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
  });
  return out;
}

std::vector<float> heights_of_keypoints(const SampledScan& scan, const FeatureCloud& features) {
  std::vector<float> heights;
  if (features.axes.empty() || scan.station_kind != StationKind::origin) return heights;
  if (!features.axes.front().upright || !features.axes.front().knows_its_end()) return heights;
  const Eigen::Vector3f up = features.axes.front().direction / static_cast<float>(scan.voxel_m);
  for (const std::uint32_t keypoint : features.keypoints)
    heights.push_back(up.dot(scan.points[keypoint] - scan.station));
  return heights;
}

std::string replaced(std::string text, const std::string& old_text, const std::string& new_text) {
  for (std::size_t at = text.find(old_text); at != std::string::npos; at = text.find(old_text, at + new_text.size())) {
    text.replace(at, old_text.size(), new_text);
  }
  return text;
}

}  // namespace

Error by_name(Error error, const io::ScanRef& ref) {
  const std::string path = ref.path.string();
  for (std::string* text : {&error.what, &error.where, &error.hint}) *text = replaced(std::move(*text), path, ref.name);
  if (error.where.empty()) error.where = ref.name;
  return error;
}

ScanPlan make_plan(int id, const io::ScanRef& ref, const std::string& content_digest, double voxel_m,
                   const std::optional<Eigen::Vector3d>& station_in_scan, const SettingsDigests& settings) {
  ScanPlan plan;
  plan.id = id;
  plan.ref = ref;
  plan.voxel_m = voxel_m;
  plan.station_in_scan = station_in_scan;
  const auto key = [](const char* stage, const char* version, const std::vector<std::string>& inputs) {
    return store::make_key(stage, version, inputs);
  };
  std::vector<std::string> inputs = {content_digest, fmt::format("{}", ref.index), fmt::format("{}", voxel_m),
                                     settings.sampling};
  if (station_in_scan)
    inputs.push_back(fmt::format("{} {} {}", station_in_scan->x(), station_in_scan->y(), station_in_scan->z()));
  plan.sampled = key("sampled", kSampledVersion, inputs);
  plan.intensity = key("intensity", kSampledVersion, {plan.sampled.digest});
  plan.features = key("features", kFeaturesVersion, {plan.sampled.digest, settings.features});
  plan.regions = key("regions", kRegionsVersion, {plan.features.digest, settings.regions});
  plan.summary = key("summary", kSummaryVersion, {plan.regions.digest});
  return plan;
}

ScanSummary summarise(const ScanProduct& product) {
  const SampledScan& scan = product.sampled;
  ScanSummary out;
  out.voxel_m = scan.voxel_m;
  out.local_origin_in_scan = scan.local_origin_in_scan;
  out.station_kind = scan.station_kind;
  out.station = scan.station;
  out.station_in_file = scan.station_in_file;
  out.spacing_m = scan.spacing_m;
  out.num_read = scan.num_read;
  out.num_dropped = scan.num_dropped;
  out.num_points = scan.points.size();
  out.num_keypoints = product.features.keypoints.size();
  out.num_regions = product.regions.regions.size();
  for (const Eigen::Vector3f& p : scan.points) out.centre += p.cast<double>();
  if (!scan.points.empty()) out.centre /= static_cast<double>(scan.points.size());
  double sq_sum = 0;
  for (const Eigen::Vector3f& p : scan.points) sq_sum += (p.cast<double>() - out.centre).squaredNorm();
  if (!scan.points.empty()) out.radius_m = std::sqrt(sq_sum / static_cast<double>(scan.points.size()));
  out.product_bytes = store::to_bytes(product).size();
  out.dimension = product.features.dimension;
  out.descriptors = coarse_descriptors(product.features);
  out.heights_voxels = heights_of_keypoints(scan, product.features);
  if (!product.features.axes.empty()) {
    const DominantAxis& axis = product.features.axes.front();
    const PlanPoints points{scan.points, scan.normals, scan.variation, out.centre.cast<float>(),
                            static_cast<float>(scan.voxel_m)};
    out.plan = ground_plan(points, z_from_axis(axis.direction), GroundPlanOptions{});
    out.plan->levels.clear();  // only columns are compared
    out.knows_up = axis.knows_its_end();
  }
  std::tie(out.outline, out.outline_cell_m) = outline_of(scan);
  out.notes = scan.notes;
  return out;
}

Result<SampledScan> ProductMaker::sampled(const ScanPlan& plan, std::vector<StageTime>& times) const {
  return load_or_make<SampledScan>(store_, plan.sampled, plan.ref.name, times,
                                   [&] { return read_and_reduce(plan, settings_.sampling, store_); });
}

Result<FeatureCloud> ProductMaker::features(const ScanPlan& plan, const SampledScan& sampled,
                                            std::vector<StageTime>& times) const {
  return load_or_make<FeatureCloud>(store_, plan.features, plan.ref.name, times,
                                    [&]() -> Result<FeatureCloud> { return describe(sampled, settings_.features); });
}

Result<RegionMap> ProductMaker::regions(const ScanPlan& plan, const SampledScan& sampled, const FeatureCloud& features,
                                        std::vector<StageTime>& times) const {
  return load_or_make<RegionMap>(store_, plan.regions, plan.ref.name, times,
                                 [&]() -> Result<RegionMap> { return divide(sampled, features, settings_.regions); });
}

Result<ScanProduct> ProductMaker::product(const ScanPlan& plan, std::vector<StageTime>& times) const {
  ScanProduct out;
  Result<SampledScan> scan = sampled(plan, times);
  if (!scan) return tl::unexpected(scan.error());
  out.sampled = std::move(*scan);
  Result<FeatureCloud> cloud = features(plan, out.sampled, times);
  if (!cloud) return tl::unexpected(cloud.error());
  out.features = std::move(*cloud);
  Result<RegionMap> map = regions(plan, out.sampled, out.features, times);
  if (!map) return tl::unexpected(map.error());
  out.regions = std::move(*map);
  return out;
}

ProductCache::ProductCache(std::size_t num_scans, std::size_t num_kept, Load load)
    : slots_(num_scans), num_kept_(num_kept), load_(std::move(load)) {}

Result<std::shared_ptr<const ScanProduct>> ProductCache::get(int id) {
  Slot& slot = slots_.at(static_cast<std::size_t>(id));
  const std::lock_guard lock(slot.mutex);
  std::shared_ptr<const ScanProduct> product = slot.product.lock();
  if (!product) {
    Result<ScanProduct> loaded = load_(id);
    if (!loaded) return tl::unexpected(loaded.error());
    product = std::make_shared<const ScanProduct>(std::move(*loaded));
    slot.product = product;
  }
  const std::lock_guard kept_lock(mutex_);
  std::erase(kept_, product);
  kept_.push_back(product);
  if (kept_.size() > num_kept_) kept_.pop_front();
  return product;
}

}  // namespace isthmus::pipelines
