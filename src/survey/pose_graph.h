// Pair results -> the survey's poses: which links to believe, which scans hang together, where each scan stands.
//
// Frames. Poses are component_from_local: from a scan's local frame (io/scan_reader.h) to the frame of its component,
// which is the local frame of the component's anchor. A link's measurement is target_from_source between local frames.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/option_table.h"
#include "geometry/transform.h"
#include "pairwise/pair_result.h"
#include "survey/control.h"

namespace isthmus {

/// One scan of the survey. Errors of links and poses are measured at its centre.
struct GraphScan {
  int id = 0;                                        ///< unique, >= 0
  std::string name;                                  ///< for reasons; the id is used where it is empty
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centroid of its points, local frame
  double radius_m = 0;                               ///< typical distance of its points from the centre; 0 = unknown

  template <class F>
  void fields(F&& f) {
    f(id), f(name), f(centre), f(radius_m);
  }
};

/// What a person did to a link.
enum class ByHand : std::uint8_t { nothing, taken_out, added };

/// One tried pair.
struct Link {
  int source = 0;
  int target = 0;
  PairResult result;
  /// The hypothesis came from poses solved before (second round): that it agrees with them proves nothing, so it has no
  /// vote.
  bool guided = false;
  /// Why the survey around it forbids the link, whatever the pair says; empty if nothing does. It is rejected.
  std::string refuted;
  /// Why the scans around its ends confirm an ambiguous link, and how probable it is with them; empty if they do not.
  std::string confirmed;
  double confirmed_probability = 0;
  ByHand by_hand = ByHand::nothing;  ///< a link that was taken out is not used; see hand_links.h
  bool first_round = false;          ///< tried on the promise of likeness and glances
  bool second_round = false;         ///< tried because solved poses or links found before proposed it

  template <class F>
  void fields(F&& f) {
    f(source), f(target), f(result), f(guided), f(refuted), f(confirmed), f(confirmed_probability), f(by_hand);
    f(first_round), f(second_round);
  }
};

struct PoseGraph {
  double voxel_m = 0;            ///< sampling of the scans; the unit of what counts as agreement; > 0
  std::vector<GraphScan> scans;  ///< every scan that was read, in any order
  std::vector<Link> links;       ///< every pair tried, in any order

  template <class F>
  void fields(F&& f) {
    f(voxel_m), f(scans), f(links);
  }
};

struct SolveOptions {
  double noise_voxels = 0.5;
  double noise_deg = 0.2;
  double agreement_chi2 = 22.46;
  double undecided_wrong_probability = 0.3;
  bool promote_ambiguous = true;
  double chance_closure = 0.003;
  double promote_probability = 0.95;
};
const config::OptionTable<SolveOptions>& solve_options_table();

/// How far a measurement is from given poses, at the centre of the source scan.
struct LinkError {
  double rotation_rad = 0;
  double translation_m = 0;
  double chi2 = 0;  ///< squared error in units of the link's own uncertainty, 6 degrees of freedom
};

struct SolvedLink {
  Link link;                           ///< verdict and reason as they are after solving
  Verdict measured = Verdict::failed;  ///< the verdict the pair stage gave
  std::optional<LinkError> before;  ///< against the spanning tree's poses; absent if the ends are not in one component
  std::optional<LinkError> after;   ///< against the final poses; absent likewise
  bool in_loop = false;             ///< accepted, and confirmed by at least one loop (false: a bridge, believed alone)
  /// That the link is right, given the loops: the pair stage's probability, raised for accepted links that a loop
  /// confirms.
  double probability = 0;
  /// As `result.information`, but as the solver weighs the link: noise floor and ceiling included. Zero if the link
  /// cannot be used.
  Matrix6d information_used = Matrix6d::Zero();
};

struct PlacedScan {
  int id = 0;
  int component = 0;
  Transform component_from_local = Transform::Identity();
  std::optional<double>
      sigma_m;  ///< standard deviation of the position of its centre relative to the anchor, worst axis
  std::optional<double> sigma_rad;  ///< likewise of the rotation
  /// Of the position of the scan's centre and of a rotation vector about it, both along the component's axes, relative
  /// to the anchor. Absent where sigma_m is.
  std::optional<Matrix6d> covariance;
};

/// Scans joined by accepted links. Components are numbered by size, largest first, then by smallest id.
struct Component {
  int anchor = 0;          ///< id of the scan with most accepted links, then the smallest id; its pose is the identity
  std::vector<int> scans;  ///< ids, ascending
  std::optional<Georeference> georeference;
};

struct Solution {
  std::vector<Component> components;   ///< every scan of the graph is in one, if only its own
  std::vector<PlacedScan> scans;       ///< ascending ids; a scan alone in its component has the identity
  std::vector<SolvedLink> links;       ///< ascending (source, target)
  std::vector<ControlResult> control;  ///< in the order of the control: points, poses, levelled scans
  std::vector<std::string> warnings;

  [[nodiscard]] const PlacedScan* find(int id) const;
};

/// target_from_source between local frames as the solved poses say, if both scans are in one component.
std::optional<Transform> predicted_target_from_source(const Solution& solution, int source, int target);

/// Lets links judge each other (loops reject accepted ones and confirm ambiguous ones), optimises the poses robustly
/// and finds the components. Method and sources: docs/stages/pose_graph.md. Runs in one thread; the same bytes for any
/// order of scans and links. Never fails: a link that cannot be used is returned with verdict failed and the reason.
/// Control does not judge links: what the loops believe is fitted to it; see docs/stages/control.md.
Solution solve(const PoseGraph& graph, const SolveOptions& options, const Control& control = {});

}  // namespace isthmus
