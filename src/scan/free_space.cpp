#include "scan/free_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace isthmus {

namespace {

FreeSpace halved(const FreeSpace& image) {
  FreeSpace out;
  out.size = image.size / 2;
  out.nearest_m.assign(6 * static_cast<std::size_t>(out.size) * out.size, std::numeric_limits<float>::infinity());
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t row = 0; row < image.size; ++row)
      for (std::size_t column = 0; column < image.size; ++column) {
        float& nearest = out.nearest_m[(face * out.size + row / 2) * out.size + column / 2];
        nearest = std::min(nearest, image.nearest_m[(face * image.size + row) * image.size + column]);
      }
  return out;
}

// Of the cells next to a cell with a return, the share that hold one themselves.
double filled_share(const FreeSpace& image) {
  std::size_t beside = 0, filled = 0;
  const std::size_t n = image.size;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t row = 1; row + 1 < n; ++row)
      for (std::size_t column = 1; column + 1 < n; ++column) {
        const float* cell = &image.nearest_m[(face * n + row) * n + column];
        if (!std::isfinite(cell[-1]) && !std::isfinite(cell[1]) && !std::isfinite(*(cell - n)) &&
            !std::isfinite(cell[n]))
          continue;
        ++beside;
        filled += std::isfinite(*cell);
      }
  return beside ? static_cast<double>(filled) / static_cast<double>(beside) : 0.0;
}

}  // namespace

FreeSpace at_scan_resolution(const FreeSpace& raw) {
  constexpr double kFilled = 0.8;
  FreeSpace image = raw;
  for (int level = 0; level < 3 && filled_share(image) < kFilled; ++level) image = halved(image);
  return image;
}

FreeSpace at_least_cells_of(const FreeSpace& image, double cell_rad) {
  constexpr std::uint32_t kSmallest = 8;
  FreeSpace out = image;
  while (out.size > kSmallest && std::numbers::pi / 2 / out.size < cell_rad) out = halved(out);
  return out;
}

FreeSpace dilated_free_space(const FreeSpace& raw) {
  constexpr int kNeighboursToFill = 3;
  FreeSpace out = raw;
  const int size = static_cast<int>(raw.size);
  const auto at = [&](int face, int row, int column) {
    return raw.nearest_m[(static_cast<std::size_t>(face) * size + row) * size + column];
  };
  for (int face = 0; face < 6; ++face)
    for (int row = 0; row < size; ++row)
      for (int column = 0; column < size; ++column) {
        float nearest = std::numeric_limits<float>::infinity();
        int seen = 0;
        for (int r = std::max(0, row - 1); r <= std::min(size - 1, row + 1); ++r)
          for (int c = std::max(0, column - 1); c <= std::min(size - 1, column + 1); ++c) {
            const float range = at(face, r, c);
            if (std::isfinite(range)) ++seen, nearest = std::min(nearest, range);
          }
        const bool empty = !std::isfinite(at(face, row, column));
        out.nearest_m[(static_cast<std::size_t>(face) * size + row) * size + column] =
            empty && seen < kNeighboursToFill ? std::numeric_limits<float>::infinity() : nearest;
      }
  return out;
}

}  // namespace isthmus
