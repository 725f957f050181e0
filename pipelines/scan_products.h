// What the store keeps of each scan: made once, loaded again, made anew when damaged.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/scan_reader.h"
#include "pairwise/register_pair.h"
#include "pipelines/settings.h"
#include "regions/ground_plan.h"
#include "store/content_digest.h"
#include "store/store.h"

namespace isthmus::pipelines {

/// A scan that is to be worked on, and where its products lie.
struct ScanPlan {
  int id = 0;
  io::ScanRef ref;
  double voxel_m = 0;
  std::optional<Eigen::Vector3d> station_in_scan;  ///< as given by the user, before the file's own word
  store::FileIdentity identity{};                  ///< of the file when its content was looked at
  std::size_t bytes = 0;                           ///< estimate of the memory that making its products needs
  store::Key sampled, features, regions, summary;
  store::Key intensity;  ///< of the finest sampling's points, for pictures; made with the sampling
};

/// The error with the scan's name wherever its path stood: the same words wherever the folder lies.
Error by_name(Error error, const io::ScanRef& ref);

/// Fills in the keys from the digest of the file's content, the voxel, the given station and the settings. Neither name
/// nor id enters a key: a renamed scan keeps its products.
ScanPlan make_plan(int id, const io::ScanRef& ref, const std::string& content_digest, double voxel_m,
                   const std::optional<Eigen::Vector3d>& station_in_scan, const SettingsDigests& settings);

/// The little that planning, pairs and reports need of a scan once its products are in the store.
struct ScanSummary {
  double voxel_m = 0;
  Eigen::Vector3d local_origin_in_scan = Eigen::Vector3d::Zero();
  StationKind station_kind = StationKind::unknown;
  Eigen::Vector3f station = Eigen::Vector3f::Zero();
  std::optional<Eigen::Vector3d> station_in_file;
  double spacing_m = 0;
  std::uint64_t num_read = 0;
  std::uint64_t num_dropped = 0;
  std::uint64_t num_points = 0;  ///< after sampling
  std::uint64_t num_keypoints = 0;
  std::uint64_t num_regions = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centroid of the sampled points, local frame
  double radius_m = 0;                               ///< root mean square distance from the centre
  std::uint64_t product_bytes = 0;                   ///< of the three products together
  std::uint32_t dimension = 0;
  std::vector<std::uint8_t> descriptors;  ///< of the keypoints, 255 for 1: enough for choosing pairs
  std::vector<float> heights_voxels;      ///< of the keypoints above the station; empty if the vertical is unknown
  std::optional<GroundPlan> plan;         ///< along the likeliest vertical, without levels; absent where there is none
  bool knows_up = false;                  ///< which end of that vertical is up
  std::vector<Eigen::Vector3f> outline;   ///< points spread over the scan, local frame, for maps and predicted overlaps
  float outline_cell_m = 0;               ///< one outline point per cell of this size
  std::vector<std::string> notes;
  template <class F>
  void fields(F&& f) {
    f(voxel_m), f(local_origin_in_scan), f(station_kind), f(station), f(station_in_file), f(spacing_m), f(num_read),
        f(num_dropped);
    f(num_points), f(num_keypoints), f(num_regions), f(centre), f(radius_m), f(product_bytes), f(dimension);
    f(descriptors), f(heights_voxels), f(plan), f(knows_up), f(outline), f(outline_cell_m), f(notes);
  }
};
ScanSummary summarise(const ScanProduct& product);

/// Seconds and whether the store had it, by stage.
struct StageTime {
  std::string stage;
  double seconds = 0;
  bool from_store = false;
};

/// Makes or loads the products of one scan, stage by stage. Every function writes what it made to the store.
class ProductMaker {
 public:
  ProductMaker(const Settings& settings, const store::Store& store) : settings_(settings), store_(store) {}

  Result<SampledScan> sampled(const ScanPlan& plan, std::vector<StageTime>& times) const;
  Result<FeatureCloud> features(const ScanPlan& plan, const SampledScan& sampled, std::vector<StageTime>& times) const;
  Result<RegionMap> regions(const ScanPlan& plan, const SampledScan& sampled, const FeatureCloud& features,
                            std::vector<StageTime>& times) const;
  /// All three.
  Result<ScanProduct> product(const ScanPlan& plan, std::vector<StageTime>& times) const;

 private:
  const Settings& settings_;
  const store::Store& store_;
};

/// Products in memory while pairs use them, and the few used last; the others are loaded again when they are needed.
class ProductCache {
 public:
  using Load = std::function<Result<ScanProduct>(int id)>;
  ProductCache(std::size_t num_scans, std::size_t num_kept, Load load);

  /// Two callers that want the same product wait for one loading. Any thread.
  Result<std::shared_ptr<const ScanProduct>> get(int id);

 private:
  struct Slot {
    std::mutex mutex;
    std::weak_ptr<const ScanProduct> product;
  };
  std::vector<Slot> slots_;
  std::size_t num_kept_;
  Load load_;
  std::mutex mutex_;
  std::deque<std::shared_ptr<const ScanProduct>> kept_;
};

}  // namespace isthmus::pipelines
