#include "survey/hand_links.h"

#include <algorithm>

#include "survey/link_model.h"

namespace isthmus {
namespace {

constexpr double kUnknownRadiusVoxels = 100;  // where the scan's radius is not known: an angle of half a degree

}  // namespace

int take_out_links(PoseGraph& graph, int a, int b) {
  int count = 0;
  for (Link& link : graph.links) {
    if (std::minmax(link.source, link.target) != std::minmax(a, b)) continue;
    link.by_hand = ByHand::taken_out;
    ++count;
  }
  return count;
}

Link link_by_hand(const PoseGraph& graph, int source, int target, const Transform& target_from_source) {
  const auto scan =
      std::find_if(graph.scans.begin(), graph.scans.end(), [&](const GraphScan& s) { return s.id == source; });
  const Eigen::Vector3d centre = scan != graph.scans.end() ? scan->centre : Eigen::Vector3d::Zero().eval();
  const double radius_m =
      scan != graph.scans.end() && scan->radius_m > 0 ? scan->radius_m : kUnknownRadiusVoxels * graph.voxel_m;
  Vector6d weight;
  weight << Eigen::Vector3d::Constant(1.0 / (graph.voxel_m * graph.voxel_m)),
      Eigen::Vector3d::Constant(radius_m * radius_m / (graph.voxel_m * graph.voxel_m));
  Link link;
  link.source = source;
  link.target = target;
  link.by_hand = ByHand::added;
  link.result.verdict = Verdict::accepted;
  link.result.reason = "added by hand";
  link.result.probability = 1;
  link.result.target_from_source = target_from_source;
  // d_centred = Ad(-centre) d_local
  const Matrix6d centred_from_local = survey::adjoint(Transform(Eigen::Translation3d(-centre)));
  link.result.information = centred_from_local.transpose() * weight.asDiagonal() * centred_from_local;
  return link;
}

}  // namespace isthmus
