// The best few transforms that differ from each other.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/transform.h"

namespace isthmus::congruent {

/// How many sample points a transform brings onto the target.
struct CountedTransform {
  Transform target_from_source = Transform::Identity();
  std::int64_t common = 0;
  int trial = 0;            ///< the one that gave this very transform
  std::vector<int> voters;  ///< the trials that led here, ascending
};

/// Keeps at most `capacity` transforms, best first; of two that carry the source to nearly the same place only the
/// better, which takes over the voters. Of equals the earlier stays, so the content depends on the order of add()
/// alone.
class BestTransforms {
 public:
  /// Transforms are the same when they move every point within `radius_m` of the source's origin by less than
  /// `distinct_m` apart. A transform needs more than `floor` common points.
  BestTransforms(std::size_t capacity, double distinct_m, double radius_m, std::int64_t floor)
      : capacity_(capacity), distinct_m_(distinct_m), radius_m_(radius_m), floor_(floor) {}

  /// True if it was kept itself; a lesser twin of a kept one only adds its voters to the best such.
  bool add(const CountedTransform& candidate);
  /// A candidate must have more common points than this to be kept.
  [[nodiscard]] std::int64_t to_beat() const { return kept_.size() < capacity_ ? floor_ : kept_.back().common; }
  [[nodiscard]] const std::vector<CountedTransform>& kept() const { return kept_; }

 private:
  [[nodiscard]] bool same(const Transform& a, const Transform& b) const;

  std::size_t capacity_;
  double distinct_m_;
  double radius_m_;
  std::int64_t floor_;
  std::vector<CountedTransform> kept_;
};

}  // namespace isthmus::congruent
