// The whole survey as one flow graph:
//
//   read, reduce -> describe -> divide -> | glances, candidates | -> pairs -> | graph | (-> more pairs -> | graph |)*
//
// Each scan goes on as soon as it is there; | | waits for all. Memory in flight is bounded by bytes (byte_gate.h); a
// failed scan or pair is data. Results are sorted by id before they leave: the same for any number of threads and order
// of files. Of a pair, the scan whose name sorts later is the source.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/events.h"
#include "pipelines/planning.h"
#include "pipelines/settings.h"
#include "pipelines/share.h"
#include "survey/pose_graph.h"

namespace isthmus::pipelines {

/// What became of one scan.
struct ScanOutcome {
  int id = 0;
  io::ScanRef ref;
  std::optional<ScanSummary> summary;  ///< absent if it failed
  std::optional<Error> error;
  std::vector<StageTime> times;
  bool missing = false;           ///< another share's, and not in the store
  store::Key sampled, intensity;  ///< where these products lie in the store; empty if the scan was not planned
};

struct PairOutcome {
  int source = 0;
  int target = 0;
  double score = 0;           ///< likeness from the choice of candidates
  bool first_round = false;   ///< tried on the promise of likeness and glances
  bool second_round = false;  ///< tried because solved poses or links found before proposed it
  bool guided = false;        ///< the result is of the second round, with the predicted pose as an extra hypothesis
  std::size_t num_found = 0;  ///< results found in the store: a pair that is tried again with a prediction has two
  std::size_t num_made = 0;   ///< results computed in this run
  bool missing = false;       ///< another share's, and not in the store
  double seconds = 0;         ///< of this run
  PairResult result;          ///< between local frames, before solving
  std::string refuted;        ///< why the scans around it forbid the link (bridge_checks.h); empty if they do not
  bool acquitted = false;     ///< refuted once and brought back: the next time is final

  std::string confirmed;  ///< why they confirm an ambiguous one (confirmed_joins.h); empty if they do not
  double confirmed_probability = 0;

  /// False if it was refuted before.
  bool refute(const std::string& reason) {
    if (!refuted.empty()) return false;
    refuted = reason;
    return true;
  }
  /// False if it was before.
  bool acquit() {
    if (acquitted) return false;
    acquitted = true;
    refuted.clear();
    return true;
  }
  /// False if it was confirmed or refuted before.
  bool confirm(const std::string& reason, double probability) {
    if (!confirmed.empty() || !refuted.empty()) return false;
    confirmed = reason, confirmed_probability = probability;
    return true;
  }
};

struct SurveyOutcome {
  double voxel_m = 0;
  bool automatic_voxel = false;
  bool stopped = false;               ///< asked to stop: what was finished is in the store, the rest is missing here
  std::vector<ScanOutcome> scans;     ///< ascending ids
  std::vector<PairOutcome> pairs;     ///< ascending (source, target)
  PoseGraph graph;                    ///< of the scans that did not fail, all pairs: what was solved in the end
  Solution solution;                  ///< of that graph
  std::vector<std::string> warnings;  ///< in a fixed order
  std::size_t num_made = 0;           ///< products computed in this run
  std::size_t num_found = 0;          ///< products found in the store
  std::size_t num_missing = 0;  ///< scans and pairs of other shares that are not in the store: there is no solution
  bool guessed = false;         ///< a look ahead went without glances or checks that no run has made yet
  std::size_t peak_bytes_in_flight = 0;
  SurveyPlan plan;  ///< what the looks at the scans found, and where the products lie
};

/// Runs in an arena of its own with settings.run.threads threads. `scans` sorted by name: the index is the id. `stop`
/// may be set at any time (signals): work in flight is finished and stored, nothing else is begun. With a share of the
/// work, the run ends at the first stage (look, scans, a wave of pairs) for which others' results are missing.
SurveyOutcome run_survey(const std::vector<io::ListedScan>& scans, const Settings& settings, const store::Store& store,
                         const Events& events, const std::atomic<bool>& stop, const Share& share = {});

}  // namespace isthmus::pipelines
