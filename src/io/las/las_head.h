// What stands before the points of a LAS or LAZ file that we write: header and variable length records.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "io/crs.h"

namespace isthmus::io {

inline constexpr double kLasScale_m = 1e-4;

/// LAS 1.4. Point format 6, or 7 with colour; 0 or 2 where the reference system is known by codes, for the standard
/// wants WKT with formats from 6 on, which cannot be made from a code without a data base.
struct LasHead {
  bool colour = false;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::optional<Crs> crs;
  std::string laz_record;  ///< LazStream::record() for compressed points, else empty

  [[nodiscard]] unsigned format() const;
  [[nodiscard]] std::size_t record_bytes() const;
  [[nodiscard]] std::size_t source_at() const;  ///< the point source id in a record
  [[nodiscard]] std::size_t colour_at() const;
  /// Header and records, of the same length whatever the count and the bounds.
  [[nodiscard]] std::string bytes(std::uint64_t count, const Eigen::Array3d& low, const Eigen::Array3d& high) const;
};

}  // namespace isthmus::io
