// One large cloud, written as its points come: LAS, LAZ, PLY (binary little endian) or PCD (binary), by extension.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/error.h"
#include "io/las/las_head.h"
#include "io/las/laz.h"
#include "io/output_file.h"

namespace isthmus::io {

/// What every point of the cloud has.
struct CloudShape {
  bool intensity = false;
  bool colour = false;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< LAS: the offset; coordinates within 200 km of it
  std::optional<Crs> crs;                            ///< LAS and LAZ alone have a place for it
};

struct CloudPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  float intensity = 0;  ///< LAS keeps whole numbers from 0 to 65535
  std::array<std::uint8_t, 3> colour{};
  std::uint16_t source = 0;  ///< which station measured it, from 1
};

/// LAS 1.4 (las_head.h), 0.1 mm steps, the source as point source id; LAZ: the same points compressed, in builds with
/// LASzip; PLY and PCD: coordinates in double precision, float intensity, the source as `source` (ushort).
class CloudWriter {
 public:
  static Result<CloudWriter> create(const std::filesystem::path& path, const CloudShape& shape);
  static bool knows(const std::filesystem::path& path);

  Result<void> add(const CloudPoint& point);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Writes counts and bounds into the header; the file appears under its name.
  Result<void> publish();

 private:
  enum class Kind : std::uint8_t { las, laz, ply, pcd };
  CloudWriter(OutputFile file, std::string name, Kind kind, const CloudShape& shape);
  Result<void> begin();
  static std::optional<Kind> kind_of(const std::filesystem::path& path);
  [[nodiscard]] std::string header() const;  ///< of the same length whatever the count
  Result<void> flush();
  Result<void> append_las(const CloudPoint& point);

  std::unique_ptr<OutputFile> file_;  // at one place: LASzip writes to it as well
  std::string name_;
  Kind kind_;
  CloudShape shape_;
  LasHead las_;
  std::unique_ptr<LazStream> laz_;
  std::string buffer_;
  std::uint64_t count_ = 0;
  Eigen::Array3d low_, high_;
};

}  // namespace isthmus::io
