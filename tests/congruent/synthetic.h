// Synthetic surfaces with known poses for the tests of this folder.
#pragma once

#include <vector>

#include "base/rng.h"
#include "congruent/oriented_cloud.h"
#include "geometry/transform.h"

namespace isthmus::congruent::test {

struct Cloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  [[nodiscard]] OrientedCloud view() const { return {points, normals}; }
  [[nodiscard]] OrientedCloud bare() const { return {points, {}}; }
};

/// A corner of a yard: ground, two walls, boxes at odd angles, a pillar and a ball; 6 m x 4 m x 2.5 m around the
/// origin. Every call with another seed samples the same surfaces anew, about one point per spacing squared, with
/// Gaussian noise on points (metres) and normals (radians). Points with x outside [x_min, x_max] are left out.
Cloud sample_yard(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min = -3,
                  double x_max = 3);

/// Rolling ground without a plane or a repetition, 6 m x 4 m; the arguments as above. Down to an
/// overlap of a half the best overlap is the truth; in the yard ground may lie on ground in better ways than the right
/// one.
Cloud sample_hills(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min = -3,
                   double x_max = 3);

/// Thirty balls of 0.2 to 0.6 m radius, scattered over 6 m x 4 m x 2 m; the arguments as above. Nothing repeats, and no
/// wrong pose overlaps much.
Cloud sample_balls(double spacing_m, double noise_m, double normal_noise_rad, std::uint64_t seed, double x_min = -3,
                   double x_max = 3);

/// `count` points evenly over a cube of the edge given, random unit normals.
Cloud random_cube(std::size_t count, double edge_m, std::uint64_t seed);

Cloud moved(const Cloud& cloud, const Transform& moved_from_cloud);

/// Any rotation, translation within +-reach_m.
Transform random_transform(Rng& rng, double reach_m);

}  // namespace isthmus::congruent::test
