#include "io/record_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace isthmus::io {
namespace {

template <class T>
T load(const char* bytes, bool swap_bytes) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swap_bytes) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

// Calls put(i, value) for i in [0, count), in double.
template <class T, class Put>
void each_value_of(const RecordField& field, bool swap_bytes, const char* data, std::size_t first, std::size_t count,
                   const Put& put) {
  if (count == 0) return;  // then there may be no data either
  const char* place = data + field.offset + first * field.step;
  for (std::size_t i = 0; i < count; ++i, place += field.step) {
    put(i, static_cast<double>(load<T>(place, swap_bytes)) * field.scale + field.add);
  }
}

template <class Put>
void each_value(const RecordField& field, bool swap_bytes, const char* data, std::size_t first, std::size_t count,
                const Put& put) {
  const auto of = [&]<class T>(T) { each_value_of<T>(field, swap_bytes, data, first, count, put); };
  switch (field.type) {
    case ScalarType::int8:
      return of(std::int8_t{});
    case ScalarType::uint8:
      return of(std::uint8_t{});
    case ScalarType::int16:
      return of(std::int16_t{});
    case ScalarType::uint16:
      return of(std::uint16_t{});
    case ScalarType::int32:
      return of(std::int32_t{});
    case ScalarType::uint32:
      return of(std::uint32_t{});
    case ScalarType::int64:
      return of(std::int64_t{});
    case ScalarType::uint64:
      return of(std::uint64_t{});
    case ScalarType::float32:
      return of(float{});
    case ScalarType::float64:
      return of(double{});
  }
}

std::uint8_t colour_byte(double value) {
  return static_cast<std::uint8_t>(value >= 0.0 ? std::min(value + 0.5, 255.0) : 0.0);  // NaN becomes 0
}

}  // namespace

std::size_t bytes_of(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
    case ScalarType::uint8:
      return 1;
    case ScalarType::int16:
    case ScalarType::uint16:
      return 2;
    case ScalarType::int32:
    case ScalarType::uint32:
    case ScalarType::float32:
      return 4;
    case ScalarType::int64:
    case ScalarType::uint64:
    case ScalarType::float64:
      return 8;
  }
  return 0;
}

void append_records(const RecordLayout& layout, const char* data, std::size_t first, std::size_t count,
                    const Eigen::Vector3d& origin, PointChunk& chunk) {
  const std::size_t start = chunk.points.size();
  chunk.points.resize(start + count, Eigen::Vector3f(0.0F, 0.0F, static_cast<float>(-origin.z())));
  const auto put_axis = [&](const RecordField& field, int axis) {
    each_value(field, layout.swap_bytes, data, first, count, [&](std::size_t i, double value) {
      chunk.points[start + i][axis] = static_cast<float>(value - origin[axis]);
    });
  };
  put_axis(layout.x, 0);
  put_axis(layout.y, 1);
  if (layout.z) put_axis(*layout.z, 2);
  if (layout.intensity) {
    chunk.intensity.resize(start + count);
    each_value(*layout.intensity, layout.swap_bytes, data, first, count,
               [&](std::size_t i, double value) { chunk.intensity[start + i] = static_cast<float>(value); });
  }
  if (layout.colour || layout.packed_rgb) chunk.colour.resize(start + count);
  for (std::size_t c = 0; layout.colour && c < 3; ++c) {
    each_value((*layout.colour)[c], layout.swap_bytes, data, first, count,
               [&](std::size_t i, double value) { chunk.colour[start + i][c] = colour_byte(value); });
  }
  if (layout.packed_rgb) {
    const RecordField& rgb = *layout.packed_rgb;
    for (std::size_t i = 0; i < count; ++i) {
      const auto bits = load<std::uint32_t>(data + rgb.offset + (first + i) * rgb.step, layout.swap_bytes);
      chunk.colour[start + i] = {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
                                 static_cast<std::uint8_t>(bits)};
    }
  }
}

std::vector<Eigen::Vector3d> positions_of_records(const RecordLayout& layout, const char* data, std::size_t first,
                                                  std::size_t count) {
  std::vector<Eigen::Vector3d> positions(count, Eigen::Vector3d::Zero());
  const auto put_axis = [&](const RecordField& field, int axis) {
    each_value(field, layout.swap_bytes, data, first, count,
               [&](std::size_t i, double value) { positions[i][axis] = value; });
  };
  put_axis(layout.x, 0);
  put_axis(layout.y, 1);
  if (layout.z) put_axis(*layout.z, 2);
  return positions;
}

void choose_colour_scale(RecordLayout& layout, const char* data, std::size_t count) {
  if (!layout.colour) return;
  double largest = 0.0;
  for (const RecordField& field : *layout.colour) {
    each_value(field, layout.swap_bytes, data, 0, count,
               [&](std::size_t, double value) { largest = std::max(largest, value); });
  }
  constexpr double kByte = 255.0;
  constexpr double kTwoBytes = 65535.0;
  for (RecordField& field : *layout.colour) {
    const bool is_float = field.type == ScalarType::float32 || field.type == ScalarType::float64;
    if (is_float && largest <= 1.0) {
      field.scale = kByte;
    } else if (bytes_of(field.type) > 1 && largest > kByte) {
      field.scale = kByte / kTwoBytes;
    }
  }
}

}  // namespace isthmus::io
