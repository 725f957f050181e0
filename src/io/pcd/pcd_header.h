// The header of a PCD file (PCL's point cloud data, versions 0.5 to 0.7).
//
//   # comment
//   VERSION 0.7
//   FIELDS x y z intensity ...
//   SIZE 4 4 4 4           bytes of one number of each field
//   TYPE F F F F           I signed, U unsigned, F floating
//   COUNT 1 1 1 1          numbers in each field; the line may be missing
//   WIDTH n / HEIGHT m
//   VIEWPOINT tx ty tz qw qx qy qz
//   POINTS n*m
//   DATA ascii | binary | binary_compressed
//
// Source: pcl.readthedocs.io, "The PCD file format". binary_compressed: uint32 compressed size, uint32 size, then one
// LZF block of the fields one after the other (all x, all y, ...).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/input_file.h"
#include "io/record_layout.h"

namespace isthmus::io {

struct PcdField {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::uint32_t count = 1;

  [[nodiscard]] std::size_t bytes() const { return bytes_of(type) * count; }
};

struct PcdHeader {
  enum class Data { ascii, binary, binary_compressed };
  std::vector<PcdField> fields;
  std::uint64_t num_points = 0;
  std::optional<Eigen::Vector3d> viewpoint;  ///< absent: not stated, or the default 0 0 0
  Data data = Data::ascii;
  std::uint64_t data_begin = 0;
  std::uint64_t data_line = 0;
  std::vector<std::string> notes;

  [[nodiscard]] std::size_t bytes_per_point() const;
};

/// Reads the header; the file then stands at data_begin. Fails without fields x and y.
Result<PcdHeader> read_pcd_header(InputFile& file);

}  // namespace isthmus::io
