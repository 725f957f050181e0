#include "congruent/congruent_sets.h"

#include <algorithm>
#include <numbers>

#include "congruent/cell_table.h"

namespace isthmus::congruent {
namespace {

// The middle of a pair as the base's diagonal sees it, and where the pair points.
struct Crossing {
  Eigen::Vector3f at;
  Eigen::Vector3f direction;  // unit
};

Crossing crossing_of(std::span<const Eigen::Vector3f> points, PointPair pair, float ratio) {
  const Eigen::Vector3f forth = points[pair.second] - points[pair.first];
  return {points[pair.first] + ratio * forth, forth.normalized()};
}

bool meet(const SetQuery& query, const Crossing& e1, const Crossing& e2) {
  const auto max_gap = static_cast<float>(query.max_gap_m);
  return (e1.at - e2.at).squaredNorm() <= max_gap * max_gap && query.angle.contains(e1.direction.dot(e2.direction));
}

bool corners_agree(const SetQuery& query, std::span<const Eigen::Vector3f> normals, PointPair ab, PointPair cd) {
  if (ab.first == cd.first || ab.first == cd.second || ab.second == cd.first || ab.second == cd.second) return false;
  if (normals.empty()) return true;
  return query.between_normals[0].contains(normals[ab.first].dot(normals[cd.first])) &&
         query.between_normals[1].contains(normals[ab.first].dot(normals[cd.second])) &&
         query.between_normals[2].contains(normals[ab.second].dot(normals[cd.first])) &&
         query.between_normals[3].contains(normals[ab.second].dot(normals[cd.second]));
}

// Directions fall into 54 bins: the faces of a cube, each cut 3 x 3; a set of bins is one word.
constexpr int kCuts = 3;
constexpr int kBins = 6 * kCuts * kCuts;

int direction_bin(const Eigen::Vector3f& d) {
  int axis = 0;
  const float largest = d.cwiseAbs().maxCoeff(&axis);
  if (!(largest > 0)) return 0;
  const auto cut = [&](int k) {
    return std::clamp(static_cast<int>((d[(axis + k) % 3] / largest + 1) * 0.5F * kCuts), 0, kCuts - 1);
  };
  return ((axis * 2 + (d[axis] > 0 ? 1 : 0)) * kCuts + cut(1)) * kCuts + cut(2);
}

struct Bin {
  Eigen::Vector3f centre;
  double radius_rad = 0;  // largest angle between the centre and a direction of the bin
};

std::array<Bin, kBins> make_bins() {
  std::array<Bin, kBins> bins;
  for (int b = 0; b < kBins; ++b) {
    const int face = b / (kCuts * kCuts), axis = face / 2, u = b / kCuts % kCuts, v = b % kCuts;
    const auto direction = [&](double cu, double cv) {
      Eigen::Vector3d d;
      d[axis] = face % 2 == 0 ? -1 : 1;
      d[(axis + 1) % 3] = 2 * cu / kCuts - 1;
      d[(axis + 2) % 3] = 2 * cv / kCuts - 1;
      return d.normalized().eval();
    };
    const Eigen::Vector3d centre = direction(u + 0.5, v + 0.5);
    double smallest_cosine = 1;
    for (const int corner : {0, 1, 2, 3})
      smallest_cosine = std::min(smallest_cosine, centre.dot(direction(u + corner % 2, v + corner / 2)));
    bins[static_cast<std::size_t>(b)] = {centre.cast<float>(), std::acos(smallest_cosine)};
  }
  return bins;
}

// Per bin, the cosines between its centre and a query direction at which some direction of the bin may match.
std::array<CosineInterval, kBins> widened(const CosineInterval& angle, const std::array<Bin, kBins>& bins) {
  constexpr double kSpare = 1e-3;  // rad, for float cosines
  const double widest = std::acos(std::clamp(static_cast<double>(angle.low), -1.0, 1.0));
  const double narrowest = std::acos(std::clamp(static_cast<double>(angle.high), -1.0, 1.0));
  std::array<CosineInterval, kBins> intervals;
  for (std::size_t b = 0; b < kBins; ++b)
    intervals[b] =
        cosines_near(std::cos(0.5 * (widest + narrowest)), 0.5 * (widest - narrowest) + bins[b].radius_rad + kSpare);
  return intervals;
}

// Crossings of the ab pairs, grouped by cell and within a cell by direction bin.
class CrossingGrid {
 public:
  CrossingGrid(const SetQuery& query, std::span<const Eigen::Vector3f> points, std::span<const PointPair> pairs,
               float inverse_edge) {
    std::vector<Crossing> crossings;
    std::vector<CellKey> bins, cells;
    for (const PointPair pair : pairs) {
      crossings.push_back(crossing_of(points, pair, static_cast<float>(query.r1)));
      bins.push_back(static_cast<CellKey>(direction_bin(crossings.back().direction)));
    }
    std::vector<std::uint32_t> by_bin, by_cell;
    const CellTable grouped_by_bin(bins, by_bin);
    for (const std::uint32_t i : by_bin) cells.push_back(cell_key(cell_of(crossings[i].at, inverse_edge)));
    cells_ = CellTable(cells, by_cell);  // keeps the order by bin within a cell
    for (const std::uint32_t k : by_cell)
      entries_.push_back({crossings[by_bin[k]], static_cast<std::uint32_t>(bins[by_bin[k]]), by_bin[k], 0});
    for (std::uint32_t e = static_cast<std::uint32_t>(entries_.size()); e-- > 0;) {
      const bool goes_on = e + 1 < entries_.size() && entries_[e + 1].bin == entries_[e].bin &&
                           cells[by_cell[e + 1]] == cells[by_cell[e]];
      entries_[e].run_end = goes_on ? entries_[e + 1].run_end : e + 1;
    }
  }

  /// Calls visit(pair, crossing) for the entries of a cell whose direction bin is in `bins()`.
  template <class Bins, class Visit>
  void visit(CellKey cell, const Bins& bins, const Visit& visit) const {
    const CellRange range = cells_.find(cell);
    if (range.end == 0) return;
    const std::uint64_t wanted = bins();
    for (std::uint32_t e = range.begin; e < range.end;) {
      if ((wanted >> entries_[e].bin & 1U) == 0) {
        e = entries_[e].run_end;
      } else {
        visit(entries_[e].pair, entries_[e].crossing);
        ++e;
      }
    }
  }

 private:
  struct Entry {
    Crossing crossing;
    std::uint32_t bin = 0;
    std::uint32_t pair = 0;
    std::uint32_t run_end = 0;  // behind the last entry of the same cell and bin
  };
  CellTable cells_;
  std::vector<Entry> entries_;
};

std::uint64_t bins_near(const Eigen::Vector3f& direction, const std::array<Bin, kBins>& bins,
                        const std::array<CosineInterval, kBins>& intervals) {
  std::uint64_t wanted = 0;
  for (std::size_t b = 0; b < kBins; ++b)
    if (intervals[b].contains(bins[b].centre.dot(direction))) wanted |= std::uint64_t{1} << b;
  return wanted;
}

}  // namespace

bool are_congruent(const SetQuery& query, std::span<const Eigen::Vector3f> points,
                   std::span<const Eigen::Vector3f> normals, PointPair ab, PointPair cd) {
  return meet(query, crossing_of(points, ab, static_cast<float>(query.r1)),
              crossing_of(points, cd, static_cast<float>(query.r2))) &&
         corners_agree(query, normals, ab, cd);
}

std::optional<std::vector<CongruentSet>> find_congruent_sets(
    const SetQuery& query, std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
    std::span<const PointPair> ab, std::span<const PointPair> cd, std::size_t max_sets, SetCounts& counts) {
  static const std::array<Bin, kBins> bins = make_bins();
  std::vector<CongruentSet> sets;
  if (ab.empty() || cd.empty()) return sets;
  const auto intervals = widened(query.angle, bins);
  // Cells twice the gap wide (and a little more, for rounding): a crossing's partners lie in the eight cells nearest
  // it.
  const float edge = 2.002F * static_cast<float>(query.max_gap_m);
  const CrossingGrid grid(query, points, ab, 1 / edge);
  bool full = false;
  for (const PointPair pair : cd) {
    const Crossing e2 = crossing_of(points, pair, static_cast<float>(query.r2));
    std::optional<std::uint64_t> wanted;  // worked out for the first cell that is not empty
    const auto wanted_bins = [&] {
      if (!wanted) wanted = bins_near(e2.direction, bins, intervals);
      return *wanted;
    };
    const Eigen::Vector3i corner = cell_of(e2.at - Eigen::Vector3f::Constant(0.5F * edge), 1 / edge);
    for (int k = 0; k < 8; ++k) {
      grid.visit(cell_key(corner + Eigen::Vector3i(k & 1, k >> 1 & 1, k >> 2)), wanted_bins,
                 [&](std::uint32_t i, const Crossing& e1) {
                   ++counts.gap_tests;
                   if (!meet(query, e1, e2) || !corners_agree(query, normals, ab[i], pair)) return;
                   full = full || sets.size() == max_sets;
                   if (!full) sets.push_back({ab[i].first, ab[i].second, pair.first, pair.second});
                 });
    }
    if (full) return std::nullopt;
  }
  return sets;
}

}  // namespace isthmus::congruent
