#include "regions/divisions.h"

#include <array>

namespace isthmus {

std::span<const Division> divisions() {
  static constexpr std::array table{
      Division{"clusters", "compact clusters of similar size", divide_by_clusters},
      Division{"planes", "planar patches and the edges between them", divide_by_planes},
      Division{"spectral", "cuts where neighbouring keypoints hang together least", divide_by_spectrum},
      Division{"differences", "surfaces bounded by steps of normals and curvature", divide_by_differences},
  };
  return table;
}

}  // namespace isthmus
