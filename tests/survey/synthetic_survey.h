// Made-up surveys with known poses: links are exact, noisy or wrong by a known amount.
#pragma once

#include <fmt/format.h>
#include <vector>

#include "base/rng.h"
#include "survey/pose_graph.h"

namespace isthmus::testing {

inline constexpr double kVoxel = 0.1;

inline Transform random_pose(Rng& rng, double range_m) {
  Transform t = Transform::Identity();
  const Eigen::Vector3d axis(rng.normal(), rng.normal(), rng.normal());
  t.linear() = rotation_from_vector(axis.normalized() * rng.uniform(0.0, 3.0));
  t.translation() =
      Eigen::Vector3d(rng.uniform(-range_m, range_m), rng.uniform(-range_m, range_m), rng.uniform(-2.0, 2.0));
  return t;
}

/// Right perturbation (translation, rotation vector).
inline Transform exp_of(const Vector6d& d) {
  Transform t = Transform::Identity();
  t.linear() = rotation_from_vector(d.tail<3>());
  t.translation() = d.head<3>();
  return t;
}

struct World {
  std::vector<Transform> world_from_local;
  PoseGraph graph;
  Rng rng{7};

  explicit World(int num_scans, std::uint64_t seed = 7) : rng(seed) {
    graph.voxel_m = kVoxel;
    for (int i = 0; i < num_scans; ++i) {
      world_from_local.push_back(random_pose(rng, 40.0));
      GraphScan scan;
      scan.id = i;
      scan.name = fmt::format("s{}", i);
      scan.centre = Eigen::Vector3d(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-1, 1));
      scan.radius_m = 15;
      graph.scans.push_back(scan);
    }
  }
  [[nodiscard]] Transform truth(int source, int target) const {
    return world_from_local[target].inverse() * world_from_local[source];
  }
  Link& add(int source, int target, const Transform& target_from_source, double probability = 0.98,
            Verdict verdict = Verdict::accepted) {
    Link link;
    link.source = source;
    link.target = target;
    link.result.verdict = verdict;
    link.result.reason = "as made";
    link.result.probability = probability;
    link.result.target_from_source = target_from_source;
    link.result.overlap = 0.3;
    // 1 cm and 0.05 deg
    link.result.information.diagonal() << 1e4, 1e4, 1e4, 1.3e6, 1.3e6, 1.3e6;
    graph.links.push_back(link);
    return graph.links.back();
  }
  /// A right link with noise of about a tenth of a voxel and its equal at 15 m.
  Link& right(int source, int target, double probability = 0.98, Verdict verdict = Verdict::accepted,
              double noise_voxels = 0.1) {
    Vector6d d;
    for (int k = 0; k < 3; ++k) d[k] = noise_voxels * kVoxel * rng.normal();
    for (int k = 3; k < 6; ++k) d[k] = noise_voxels * kVoxel / 15.0 * rng.normal();
    return add(source, target, truth(source, target) * exp_of(d), probability, verdict);
  }
  Link& exact(int source, int target, double probability = 0.98, Verdict verdict = Verdict::accepted) {
    return add(source, target, truth(source, target), probability, verdict);
  }
  /// Somewhere else altogether.
  Link& wrong(int source, int target, double probability = 0.9, Verdict verdict = Verdict::accepted) {
    return add(source, target, random_pose(rng, 40.0), probability, verdict);
  }
  /// Wrong by a sideways shift, as repeated windows do it.
  Link& shifted(int source, int target, double metres, double probability = 0.9, Verdict verdict = Verdict::accepted) {
    Transform t = truth(source, target);
    t.translation().x() += metres;
    return add(source, target, t, probability, verdict);
  }
};

inline const SolvedLink* find_link(const Solution& solution, int source, int target) {
  for (const SolvedLink& l : solution.links)
    if (l.link.source == source && l.link.target == target) return &l;
  return nullptr;
}

/// Largest distance of a solved relative pose from the truth at the source's centre, over all scans of the anchor's
/// component.
inline double worst_error_m(const World& world, const Solution& solution, int component = 0) {
  const Component& part = solution.components.at(component);
  double worst = 0;
  for (const int id : part.scans) {
    const auto t = predicted_target_from_source(solution, id, part.anchor);
    if (!t) return 1e9;
    worst = std::max(worst, displacement_m(*t, world.truth(id, part.anchor), world.graph.scans[id].centre));
  }
  return worst;
}

}  // namespace isthmus::testing
