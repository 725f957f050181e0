// All point pairs at a given distance, in time that follows the number of pairs found.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "congruent/cosine_interval.h"

namespace isthmus::congruent {

/// An ordered pair: `first` may stand for the beginning of a diagonal and `second` for its end.
struct PointPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  friend auto operator<=>(const PointPair&, const PointPair&) = default;
};

/// What a point of the target may stand for: bits that can be joined.
enum PointRole : std::uint8_t { kNoRole = 0, kFirstRole = 1, kSecondRole = 2, kBothRoles = 3 };

/// The diagonal whose likenesses are sought. Angles are compared only when the index has normals.
struct PairQuery {
  float min_distance_m = 0;
  float max_distance_m = 0;
  CosineInterval between_normals{};              ///< first normal, second normal
  CosineInterval first_normal{};                 ///< first normal, direction from first to second
  CosineInterval second_normal{};                ///< second normal, direction from first to second
  Eigen::Vector3f up = Eigen::Vector3f::Zero();  ///< unit vertical; zero = heights are not compared
  float min_rise_m = 0;                          ///< height of second above first along `up`
  float max_rise_m = 0;
};

struct PairCounts {
  std::uint64_t cell_tests = 0;      ///< sphere against cell of the octree
  std::uint64_t distance_tests = 0;  ///< point against point
};

/// True if (first, second) answers the query; the one definition that the index and its brute-force twin share.
bool answers(const PairQuery& query, std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
             PointPair pair);

/// Smart indexing (Mellado, Aiger, Mitra 2014): the spheres of radius d around all points descend together
/// through an octree, each cell handing down only the spheres whose shell [d - eps, d + eps] crosses it. We differ in
/// using the tight boxes of the points in a cell, in keeping each unordered pair once on the way down, and in pruning
/// by role. Holds copies of nothing outside itself; safe to query from several threads.
class PairIndex {
 public:
  /// `normals` is empty or as long as `points`.
  PairIndex(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals);

  /// Every ordered pair of different points that answers the query and whose roles allow it, in a deterministic order.
  /// `roles` has one entry a point, or is empty when every point may stand for both ends. Nothing when there are more
  /// than `max_pairs`.
  [[nodiscard]] std::optional<std::vector<PointPair>> find(const PairQuery& query, std::span<const std::uint8_t> roles,
                                                           std::size_t max_pairs, PairCounts& counts) const;

 private:
  struct Node {
    Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();  // tight box of its points
    std::uint32_t begin = 0, end = 0;                                               // its points
    std::uint32_t child = 0, num_children = 0;  // children are consecutive; none = leaf
  };
  struct Search;
  void split(std::uint32_t node, int depth);

  std::vector<Node> nodes_;               // a parent comes before its children
  std::vector<std::uint32_t> order_;      // point index by place in the tree
  std::vector<Eigen::Vector3f> points_;   // by place in the tree
  std::vector<Eigen::Vector3f> normals_;  // by place in the tree, or empty
};

}  // namespace isthmus::congruent
