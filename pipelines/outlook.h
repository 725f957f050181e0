// Before a run: what it would compute, what it would find, and why.
#pragma once

#include <string>
#include <vector>

#include "pipelines/job.h"

namespace isthmus::pipelines {

/// Items that are to be computed for the same reason.
struct OutlookGroup {
  std::string why;                 ///< "new or changed file", "pair.max_seeds is 100 instead of 300"
  std::vector<std::string> items;  ///< "scan_003.ply", "scan_003.ply with scan_001.ply"
};

struct Outlook {
  std::size_t num_scans = 0;
  double voxel_m = 0;           ///< 0 if no scan can be read
  std::size_t scans_found = 0;  ///< whose products are in the store
  std::size_t scans_to_make = 0;
  std::size_t scans_failed = 0;  ///< cannot be read or are in another unit
  std::size_t pairs_found = 0;
  std::size_t pairs_to_make = 0;   ///< known ones
  bool pairs_are_known = false;    ///< else pairs_to_make is an upper bound for the first round
  bool pairs_are_guessed = false;  ///< known by likeness alone: glances that no run has cast yet may choose others
  bool is_complete = false;        ///< nothing is to be computed, in later rounds neither
  std::vector<OutlookGroup> scans;
  std::vector<OutlookGroup> pairs;
  double seconds = 0;           ///< expected, with the job's threads
  std::size_t timed_items = 0;  ///< scans and pairs of earlier runs that the time is from; 0: from general figures
  double most_bytes = 0;        ///< of memory
  std::vector<std::string> warnings;
};

/// Reads digests that are remembered, not scans; of new or changed files only a probe. Reasons come from comparing with
/// the last finished run of the output (run.json). Writes nothing. Fails when there are no scans.
Result<Outlook> look_ahead(const Job& job);

}  // namespace isthmus::pipelines
