#include "scan/free_space.h"

#include <algorithm>
#include <limits>

namespace isthmus {

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
