// All scans' descriptors -> which pairs to try, most promising first.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "config/option_table.h"
#include "regions/ground_plan.h"
#include "survey/visual_words.h"

namespace isthmus {

/// What the choice of pairs needs of one scan.
struct CandidateInput {
  int id = 0;        ///< unique
  std::string name;  ///< unique; what the answer depends on, instead of the order of the files
  survey::DescriptorView descriptors;
  std::optional<GroundPlan> plan;                 ///< along the likeliest vertical; absent where the scan shows none
  bool knows_up = false;                          ///< which end of that vertical is up
  std::optional<Eigen::Vector3d> prior_position;  ///< of the station, metres, one frame for all scans that have it
};

struct CandidateOptions {
  int all_pairs_up_to = 24;
  int pairs_per_scan = 5;
  int screened_per_scan = 24;
  int file_order_neighbours = 0;
  std::vector<std::string> groups;
  bool only_groups = false;
  std::string positions;
  bool file_positions = true;
  std::optional<double> max_distance_m;
  bool check_units = true;
};
const config::OptionTable<CandidateOptions>& candidate_options_table();

struct Candidate {
  int source = 0;    ///< id; the scan whose name sorts later, byte by byte
  int target = 0;    ///< id
  double score = 0;  ///< promise: likeness of words and plans in [0, 1] and, where screened, what a glance found;
                     ///< damped by distance
  std::string why;   ///< "all pairs", "likeness", "connects", "group", "file order"
};

struct CandidateGraph {
  std::vector<Candidate> candidates;  ///< best score first, then by the scans' names
  std::vector<Candidate> reserve;  ///< what the budget leaves for later, in the same order; empty where all are tried
  std::vector<std::string> warnings;  ///< group entries that match no scan, parts that no pair may connect
};

/// What a glance at a pair found (pairwise/screen_pair.h).
struct ScreenedPair {
  int source = 0;  ///< ids
  int target = 0;
  double score = 0;
};

/// Casts glances at pairs (source, target) of ids; pairs about which a glance says nothing are missing from the answer.
using CastGlances = std::function<std::vector<ScreenedPair>(std::span<const std::pair<int, int>>)>;

/// Compares the ground plans of pairs of ids: the answers of `compare(k)` for each pair k, a few milliseconds each, may
/// be called from any thread. Who gives it decides about threads, and may keep answers or leave zeros when told to
/// stop.
using ComparePlans = std::function<std::vector<float>(std::span<const std::pair<int, int>> pairs,
                                                      const std::function<float(std::size_t k)>& compare)>;

/// Bags of visual words compared by tf-idf (Sivic, Zisserman 2003); a word is the signs of a descriptor's distances to
/// random planes from a fixed seed (locality-sensitive hashing, Charikar 2002), so nothing is trained; where both scans
/// know their vertical, a word counts only at its own height above the station. Where both have a ground plan, how well
/// one can be laid on the other is a second opinion (regions/plan_likeness.h); each scan ranks the others by both,
/// and the ranks are fused (reciprocal rank fusion, Cormack, Clarke, Büttcher 2009). The same graph
/// for any order of the inputs and any thread count. Precondition: equal dimensions, unique ids and names.
/// Unless all pairs are tried anyway, or nothing but groups is wanted, `cast` is asked once about each scan's
/// `screened_per_scan` most alike, ascending by the scans' names: what it finds raises their promise, the others keep a
/// little of their promise.
CandidateGraph propose_candidates(std::span<const CandidateInput> scans, const CandidateOptions& options,
                                  const CastGlances& cast = {}, const ComparePlans& compare_plans = {});

/// Names as people sort them: runs of digits compare as numbers ("s2" before "s10").
bool natural_less(std::string_view a, std::string_view b);

}  // namespace isthmus
