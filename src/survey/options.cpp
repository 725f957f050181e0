#include <limits>

#include "survey/candidates.h"
#include "survey/pose_graph.h"

namespace isthmus {
namespace {
constexpr double kInf = std::numeric_limits<double>::infinity();
}

const config::OptionTable<SolveOptions>& solve_options_table() {
  using O = SolveOptions;
  static const config::OptionTable<SolveOptions> table{
      "solve",
      "From links to poses: which links the loops confirm or refute, and where each scan stands.",
      {
          {"noise_voxels",
           &O::noise_voxels,
           "voxels",
           0.001,
           10,
           {},
           "Standard deviation of every link beyond its own information matrix: sampling, drift and movement in the "
           "scans, at the scan's centre and (as rotation) at its radius.",
           "a point-to-plane fit averages over the voxels but not over what is common to them; "
           "docs/stages/pose_graph.md"},
          {"noise_deg",
           &O::noise_deg,
           "deg",
           0.001,
           10,
           {},
           "The same for rotations where the scan's radius is not known.",
           "half a voxel of 0.2 m at 30 m"},
          {"agreement_chi2",
           &O::agreement_chi2,
           "",
           1,
           1000,
           {},
           "Squared error, in units of its uncertainty, above which a link contradicts a loop or the poses.",
           "99.9 % of a chi-square distribution with 6 degrees of freedom"},
          {"undecided_wrong_probability",
           &O::undecided_wrong_probability,
           "",
           0.05,
           1,
           {},
           "When a loop does not close and nothing else tells which of its links is wrong, every link at least this "
           "likely to be the wrong one is rejected. 1 rejects only the least probable link.",
           "a wrong link bends the survey; three equal links of a triangle are each wrong with 1/3"},
          {"promote_ambiguous",
           &O::promote_ambiguous,
           "",
           -kInf,
           kInf,
           {},
           "Accept ambiguous links that agree with the solved poses, or with each other.",
           "an honest 'ambiguous' is decided by the loops"},
          {"chance_closure",
           &O::chance_closure,
           "",
           1e-6,
           0.5,
           {},
           "How often a wrong link agrees with a loop by chance or because the scene repeats itself.",
           "measured: 1 of 546 triangles with two or more wrong links closed within 4 voxels; "
           "docs/stages/pose_graph.md"},
          {"promote_probability",
           &O::promote_probability,
           "",
           0.5,
           0.9999,
           {},
           "Ambiguous links are accepted when the probability that they are right, given the agreement, reaches this.",
           "the price of a wrong link is much higher than that of a missing one"},
      }};
  return table;
}

const config::OptionTable<CandidateOptions>& candidate_options_table() {
  using O = CandidateOptions;
  static const config::OptionTable<CandidateOptions> table{
      "candidates",
      "Which pairs of scans are worth trying, most promising first.",
      {
          {"all_pairs_up_to",
           &O::all_pairs_up_to,
           "scans",
           0,
           100000,
           {},
           "Up to this many scans every pair is tried; above it, a budget per scan by likeness.",
           "276 pairs: minutes on one machine"},
          {"pairs_per_scan",
           &O::pairs_per_scan,
           "",
           1,
           10000,
           {},
           "Above all_pairs_up_to: so many pairs a scan are tried on the promise of a glance, half of them at once, "
           "the "
           "others where the results leave scans unplaced; and twice as many that solved poses predict to overlap.",
           "a station of a survey sees three to six neighbours well"},
          {"screened_per_scan",
           &O::screened_per_scan,
           "",
           0,
           10000,
           {},
           "Above all_pairs_up_to: a glance (a tenth of a registration) is cast at the pairs of each scan with this "
           "many "
           "of those most alike by words and ground plans; 0: none, these alone choose.",
           "docs/stages/candidates.md, table of recall"},
          {"file_order_neighbours",
           &O::file_order_neighbours,
           "",
           0,
           1000,
           {},
           "Also try each scan with this many that follow it in natural order of the names; 0: the order means "
           "nothing.",
           "file order is a hint that only the surveyor can give"},
          {"groups",
           &O::groups,
           "",
           -kInf,
           kInf,
           {},
           "Each entry names two or more scans, separated by blanks, whose pairs are all tried whatever the budget; "
           "* and ? match as in a shell: 'floor1/* stairs.ply'.",
           "the surveyor knows"},
          {"only_groups",
           &O::only_groups,
           "",
           -kInf,
           kInf,
           {},
           "Try nothing but the pairs of the groups.",
           "for repeating part of a survey"},
          {"check_units",
           &O::check_units,
           "",
           -kInf,
           kInf,
           {},
           "Leave out a scan whose extent says that it is in another unit than the others, such as millimetres among "
           "metres.",
           "its pairs could only be wrong; sizes that differ tenfold are left alone"},
          {"positions",
           &O::positions,
           "",
           -kInf,
           kInf,
           {},
           "CSV file of approximate positions of the stations, columns scan,x,y,z in metres: near pairs are tried "
           "first. Scans "
           "that it does not name are compared by likeness alone.",
           "a sketch, a phone or a total station knows them; poses are never taken from it"},
          {"file_positions",
           &O::file_positions,
           "",
           -kInf,
           kInf,
           {},
           "Without a file of positions: take those that the scans' own files store with their poses (E57, PTX), as "
           "far as "
           "they tell the stations apart.",
           "field software often knows roughly where a station was; poses are never taken from it"},
          {"max_distance_m",
           &O::max_distance_m,
           "m",
           0,
           1e7,
           {},
           "Where both scans have a prior position: pairs farther apart are not tried.",
           "automatic: no limit, near pairs only rank higher"},
      }};
  return table;
}

}  // namespace isthmus
