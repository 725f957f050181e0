// The score of a transform: the largest common point set (LCP) by a fixed sample of the source.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/rng.h"
#include "congruent/cell_table.h"
#include "congruent/oriented_cloud.h"
#include "geometry/transform.h"

namespace isthmus::congruent {

/// Answers "is there a target point within the tolerance that faces this way?" by one look into a grid whose cells hold
/// every target point within the tolerance of any place in the cell.
class FacingGrid {
 public:
  /// Without normals in `target` every point faces every way. tolerance_m > 0.
  FacingGrid(const LocalCloud& target, double tolerance_m, double facing_tolerance_rad);

  [[nodiscard]] bool has_facing(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;
  /// The nearest facing target point within the tolerance; the lower index wins a tie.
  [[nodiscard]] std::optional<std::uint32_t> nearest_facing(const Eigen::Vector3f& point,
                                                            const Eigen::Vector3f& normal) const;

 private:
  [[nodiscard]] CellRange cell_at(const Eigen::Vector3f& point) const;
  [[nodiscard]] bool faces(std::uint32_t i, const Eigen::Vector3f& normal) const {
    return normals_.empty() || normals_[i].dot(normal) >= min_cosine_;
  }

  CellTable cells_;
  std::vector<std::uint32_t> entries_;  // target points by cell; a point is entered in every cell it is near
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;
  float sq_tolerance_ = 0;
  float inverse_edge_ = 0;
  float min_cosine_ = 0;
};

/// The source points that score transforms, in an order drawn once: any leading part is itself a fair sample.
struct ScoreSample {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< as many, or empty
};
ScoreSample draw_sample(const LocalCloud& source, std::size_t size, Rng& rng);

struct ScoreCounts {
  std::uint64_t points_looked_up = 0;
};

/// Number of sample points, of the leading `size`, that land within the tolerance of a facing target point. Gives up,
/// with nothing, as soon as the points left can no longer bring the number above `to_beat`: so a result is exact and
/// always above `to_beat` (-1 = count to the end).
std::optional<std::int64_t> count_leading(const FacingGrid& target, const ScoreSample& sample, std::size_t size,
                                          const Transform& target_from_source, std::int64_t to_beat,
                                          ScoreCounts& counts);

/// The same over the whole sample.
std::optional<std::int64_t> count_common(const FacingGrid& target, const ScoreSample& sample,
                                         const Transform& target_from_source, std::int64_t to_beat,
                                         ScoreCounts& counts);

}  // namespace isthmus::congruent
