// Binary point records: which bytes of a record are which coordinate, and how they become points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

enum class ScalarType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::size_t bytes_of(ScalarType type);

/// One number per record: value = stored * scale + add.
struct RecordField {
  ScalarType type = ScalarType::float32;
  std::size_t offset = 0;  ///< of the first record's value from the start of the block, bytes
  std::size_t step = 0;    ///< from one record's value to the next one's, bytes
  double scale = 1.0;
  double add = 0.0;
};

struct RecordLayout {
  std::size_t bytes_per_record = 0;
  bool swap_bytes = false;  ///< the file's byte order is not this machine's
  RecordField x, y;
  std::optional<RecordField> z;  ///< absent: 0
  std::optional<RecordField> intensity;
  std::optional<std::array<RecordField, 3>> colour;  ///< values scaled to 0..255
  std::optional<RecordField> packed_rgb;             ///< 0x00RRGGBB in the bits of a 32-bit value (PCL)
};

/// Appends records [first, first + count) of the block at `data` to `chunk`, coordinates minus `origin` (in double).
void append_records(const RecordLayout& layout, const char* data, std::size_t first, std::size_t count,
                    const Eigen::Vector3d& origin, PointChunk& chunk);

/// The coordinates of records [first, first + count) in double, for choosing an origin.
std::vector<Eigen::Vector3d> positions_of_records(const RecordLayout& layout, const char* data, std::size_t first,
                                                  std::size_t count);

/// Sets the scales of colour fields wider than a byte from a sample of records: integers that never exceed 255 are
/// taken as 0..255, wider ones as 16 bits, floats up to 1 as 0..1.
void choose_colour_scale(RecordLayout& layout, const char* data, std::size_t count);

}  // namespace isthmus::io
