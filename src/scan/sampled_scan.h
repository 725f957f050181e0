// One scan after streaming voxel sampling: what every later stage works on.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace isthmus {

/// Where the scanner stood, and how we know.
enum class StationKind : std::uint8_t {
  unknown,    ///< no single viewpoint explains the points (fused, cut or merged clouds): no free space is used
  origin,     ///< the scan's origin (or the file's own word), confirmed by the points: each direction shows one surface
  estimated,  ///< another viewpoint found from the points (single-view range images whose origin is elsewhere)
};

/// What the scanner looked through: for each direction from the station the nearest range at which anything was seen.
/// A cube map of 6 faces with size x size cells (about 90 / size degrees each); +inf where nothing came back.
struct FreeSpace {
  std::uint32_t size = 0;
  std::vector<float> nearest_m;  ///< 6 * size * size, the minimum over a cell and its neighbours
  template <class F>
  void fields(F&& f) {
    f(size), f(nearest_m);
  }
};

/// A finer sampling of the same surfaces, for the last alignment and the evidence.
struct SurfacePoints {
  double voxel_m = 0;
  std::vector<Eigen::Vector3f> points;   ///< local frame, metres, sorted by voxel index
  std::vector<Eigen::Vector3f> normals;  ///< unit, oriented as those of the scan
  std::vector<float> variation;          ///< as in SampledScan
  template <class F>
  void fields(F&& f) {
    f(voxel_m), f(points), f(normals), f(variation);
  }
};

/// Voxel centroids with normals, in the scan's local frame (see io/scan_reader.h), metres.
struct SampledScan {
  double voxel_m = 0;  ///< edge of the sampling voxels
  Eigen::Vector3d local_origin_in_scan = Eigen::Vector3d::Zero();
  StationKind station_kind = StationKind::unknown;
  Eigen::Vector3f station = Eigen::Vector3f::Zero();  ///< in the local frame; meaningful unless unknown
  std::optional<Eigen::Vector3d> station_in_file;     ///< by the pose that the file stores for the scan, if any
  double station_sigma_m = 0;                         ///< how far from `station` the scanner may have stood
  double blocked_share =
      0;  ///< sight lines from the station that pass through a surface: how far free space can be trusted
  std::vector<Eigen::Vector3f> points;      ///< one centroid per voxel, sorted by voxel index
  std::vector<Eigen::Vector3f> normals;     ///< unit, oriented to the station
  std::vector<float> variation;             ///< surface variation l0/(l0+l1+l2): 0 plane, 1/3 scatter; 1: no normal
  std::vector<std::uint32_t> counts;        ///< raw points per voxel
  SurfacePoints fine;                       ///< empty where the scan is too sparse for a finer voxel
  FreeSpace free_space;                     ///< empty when the station is unknown
  double spacing_m = 0;                     ///< median distance to the nearest neighbour of raw points
  std::uint64_t num_read = 0;               ///< points in the file
  std::uint64_t num_dropped = 0;            ///< NaN, at the origin, no-return shells
  std::optional<double> no_return_range_m;  ///< a shell of constant range that was dropped
  std::vector<std::string> notes;           ///< for the log and the report

  template <class F>
  void fields(F&& f) {
    f(voxel_m), f(local_origin_in_scan), f(station_kind), f(station), f(station_in_file), f(station_sigma_m),
        f(blocked_share), f(points), f(normals), f(variation), f(counts), f(fine), f(free_space);
    f(spacing_m), f(num_read), f(num_dropped), f(no_return_range_m), f(notes);
  }
};

}  // namespace isthmus
