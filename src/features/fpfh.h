// Fast point feature histograms over one shared neighbourhood search.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace isthmus {

inline constexpr std::uint32_t kFpfhDimension = 33;

/// FPFH (Rusu, Blodow, Beetz 2009) of the points `queries` (indices), three blocks of 11 bins each summing to 1, a row
/// of 33 floats per query. Pair features, bins and the 1/distance^2 weights are PCL's; unlike PCL's, histograms of the
/// neighbours are computed once. `carriers` (indices) are the points whose simplified histograms are summed: all
/// points, or an even thinning of them for large radii. A query without carriers in reach gets a row of zeros.
std::vector<float> fpfh(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                        std::span<const std::uint32_t> carriers, std::span<const std::uint32_t> queries,
                        float radius_m);

}  // namespace isthmus
