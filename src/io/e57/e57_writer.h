// Writes E57 files: Cartesian coordinates as floats or doubles, intensity as float, colour as bytes, name, guid and
// pose.
#pragma once

#include <memory>

#include "io/scan_reader.h"

namespace isthmus::io {

struct E57ScanInfo {
  std::string name;
  std::string guid;                         ///< empty: made from name and points, the same for the same scan
  std::optional<Transform> file_from_scan;  ///< absent: no pose is written
  bool double_coordinates = false;
  bool has_intensity = false;
  bool has_colour = false;
};

/// Points are streamed; memory: one packet. The bytes depend on what is written alone (no time, no random guid).
class E57Writer {
 public:
  /// `coordinates`: the reference system of the file's frame, as its coordinateMetadata says it; empty: none.
  static Result<E57Writer> create(const std::filesystem::path& path, const std::string& coordinates = {});
  E57Writer(E57Writer&&) noexcept;
  E57Writer& operator=(E57Writer&&) noexcept;
  ~E57Writer();

  /// Begins a scan (and ends the one before).
  Result<void> begin_scan(E57ScanInfo info);
  /// Appends points to the scan begun last, in its frame: p_in_scan = p_in_local + local_origin_in_scan. Fails if the
  /// chunk's arrays are not those announced.
  Result<void> add(const PointChunk& points, const Eigen::Vector3d& local_origin_in_scan = Eigen::Vector3d::Zero());
  /// Ends the file, which appears under its name; without it nothing is left behind.
  Result<void> publish();

 private:
  struct State;
  explicit E57Writer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace isthmus::io
