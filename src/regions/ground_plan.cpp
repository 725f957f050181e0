#include "regions/ground_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>

#include "regions/upright_memo.h"

namespace isthmus {
namespace {

constexpr float kMaxUpright = 0.5f;     // of a normal along the axis: walls, trunks
constexpr float kMinHorizontal = 0.8f;  // floors, ground, ceilings, tables
constexpr float kClearFacing = 0.7f;    // mean resultant length of a column's headings: below it, it faces no one way

std::int64_t cell_of(float value, float cell_m) { return static_cast<std::int64_t>(std::floor(value / cell_m)); }

// Rare facings count: the weight falls with the number of columns around that face the same way.
void weigh_columns(std::vector<Column>& columns, float cell_m) {
  constexpr float kNeighbourhoodCells = 12, kSameFacing = 0.5f;
  const float reach = kNeighbourhoodCells * cell_m;
  std::vector<float> weight(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    int alike = 0;
    for (const Column& other : columns) {
      if ((other.p - columns[i].p).squaredNorm() > reach * reach) continue;
      alike += other.faces == columns[i].faces &&
               (!other.faces || std::abs(wrapped(other.heading - columns[i].heading)) < kSameFacing);
    }
    weight[i] = 1 / std::sqrt(static_cast<float>(std::max(alike, 1)));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].weight = weight[i];
}

}  // namespace

Eigen::Matrix3f z_from_axis(const Eigen::Vector3f& axis) {
  return Eigen::Quaternionf::FromTwoVectors(axis, Eigen::Vector3f::UnitZ()).toRotationMatrix();
}

GroundPlan ground_plan(const PlanPoints& scan, const Eigen::Matrix3f& z_from_scan, const GroundPlanOptions& options) {
  const float voxel = scan.voxel_m, cell = options.cell_voxels * voxel;
  struct Pile {
    Eigen::Vector2f sum = Eigen::Vector2f::Zero(), facing = Eigen::Vector2f::Zero();
    float n = 0, bottom = std::numeric_limits<float>::infinity(), top = -std::numeric_limits<float>::infinity();
    std::vector<std::int64_t> layers;
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Pile> piles;  // sorted: the order of columns is the same everywhere
  GroundPlan plan;
  plan.cell_m = cell;
  constexpr std::size_t kMaxLevels = 250;
  std::vector<Level> levels;
  const Eigen::Vector3f middle = z_from_scan * scan.middle;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f p = z_from_scan * scan.points[i] - middle, n = z_from_scan * scan.normals[i];
    if (scan.variation[i] >= 1) continue;
    if (std::abs(n.z()) > kMinHorizontal) levels.push_back({p.head<2>(), p.z(), n.z() > 0});
    if (std::abs(n.z()) > kMaxUpright) continue;
    Pile& pile = piles[{cell_of(p.x(), cell), cell_of(p.y(), cell)}];
    pile.sum += p.head<2>(), pile.facing += n.head<2>().normalized(), pile.n += 1;
    pile.bottom = std::min(pile.bottom, p.z()), pile.top = std::max(pile.top, p.z());
    pile.layers.push_back(cell_of(p.z(), voxel));
  }
  for (auto& [key, pile] : piles) {
    std::sort(pile.layers.begin(), pile.layers.end());
    const auto layers = std::unique(pile.layers.begin(), pile.layers.end()) - pile.layers.begin();
    if (layers < options.min_height_voxels) continue;
    Column column;
    column.p = pile.sum / pile.n;
    column.heading = std::atan2(pile.facing.y(), pile.facing.x());
    column.faces = pile.facing.norm() > kClearFacing * pile.n;
    column.bottom = pile.bottom, column.top = pile.top;
    plan.columns.push_back(column);
  }
  weigh_columns(plan.columns, cell);
  if (plan.columns.size() > options.max_columns) {  // the rarest; ties in the order of cells
    std::stable_sort(plan.columns.begin(), plan.columns.end(),
                     [](const Column& a, const Column& b) { return a.weight > b.weight; });
    plan.columns.resize(options.max_columns);
  }
  for (const Column& c : plan.columns) plan.radius_m = std::max(plan.radius_m, c.p.norm());
  const std::size_t stride = std::max<std::size_t>(1, levels.size() / kMaxLevels);
  for (std::size_t i = 0; i < levels.size(); i += stride) plan.levels.push_back(levels[i]);
  return plan;
}

std::shared_ptr<const GroundPlan> ground_plan(const ScanModel& model, const Eigen::Matrix3f& z_from_scan,
                                              const GroundPlanOptions& options) {
  return model.uprights().plan(z_from_scan, options, [&] {
    return ground_plan(PlanPoints{model.points, model.normals, model.variation, model.centroid, model.voxel_m},
                       z_from_scan, options);
  });
}

PlanHeights::PlanHeights(const GroundPlan& plan, float cell_m) : cell_m_(cell_m) {
  for (const Level& l : plan.levels) at_[key(l.p)].push_back({l.z, l.up ? kUp : kDown});
  for (const Column& c : plan.columns) {
    at_[key(c.p)].push_back({c.bottom, kBottom});
    at_[key(c.p)].push_back({c.top, kTop});
  }
}

std::vector<float> PlanHeights::shifts(const GroundPlan& source, const PlanPose& peak, float bin_m) const {
  std::map<std::int64_t, float> votes;
  const Eigen::Rotation2Df turn(peak.yaw);
  const auto vote = [&](const Eigen::Vector2f& p, float z, int kind, float weight) {
    const auto found = at_.find(key(turn * p + peak.shift));
    if (found == at_.end()) return;
    for (const auto& [height, other] : found->second)
      if (other == kind) votes[cell_of(height - z, bin_m)] += weight / static_cast<float>(found->second.size());
  };
  for (const Level& l : source.levels) vote(l.p, l.z, l.up ? kUp : kDown, 1);
  const std::size_t stride = std::max<std::size_t>(1, source.columns.size() / kMaxColumns);
  for (std::size_t i = 0; i < source.columns.size(); i += stride) {
    const Column& c = source.columns[i];
    vote(c.p, c.bottom, kBottom, c.weight), vote(c.p, c.top, kTop, c.weight);
  }
  std::vector<std::pair<float, std::int64_t>> sums;
  for (const auto& [bin, weight] : votes) {
    const auto next = votes.find(bin + 1), before = votes.find(bin - 1);
    sums.emplace_back(weight + (next != votes.end() ? next->second : 0) + (before != votes.end() ? before->second : 0),
                      bin);
  }
  std::stable_sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<float> out;
  for (const auto& [weight, bin] : sums) {
    const float z = (static_cast<float>(bin) + 0.5f) * bin_m;
    constexpr std::size_t kMost = 2;
    constexpr float kApartBins = 2.5f;
    if (!out.empty() && std::abs(z - out.front()) < kApartBins * bin_m) continue;
    out.push_back(z);
    if (out.size() == kMost) break;
  }
  return out;
}

std::uint64_t PlanHeights::key(const Eigen::Vector2f& p) const {
  return static_cast<std::uint64_t>(cell_of(p.x(), cell_m_)) << 32 ^
         (static_cast<std::uint64_t>(cell_of(p.y(), cell_m_)) & 0xffffffffULL);
}
Pose3f pose_of_plan(const ScanModel& source, const ScanModel& target, const Eigen::Matrix3f& z_from_source,
                    const Eigen::Matrix3f& z_from_target, const PlanPose& pose, float height_m) {
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(pose.yaw, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  const Eigen::Vector3f source_middle = z_from_source * source.centroid,
                        target_middle = z_from_target * target.centroid;
  const Eigen::Vector3f shift(pose.shift.x(), pose.shift.y(), height_m);
  return {z_from_target.transpose() * turn * z_from_source,
          z_from_target.transpose() * (target_middle + shift - turn * source_middle)};
}

}  // namespace isthmus
