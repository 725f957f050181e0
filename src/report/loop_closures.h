// How far each link is from closing the shortest loop that other accepted links make with it.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "report/survey_record.h"

namespace isthmus::report {

struct LoopClosure {
  std::vector<int> via;      ///< ids of the scans between the link's source and its target, in that order
  double translation_m = 0;  ///< between where link and loop put the source's centre
  double rotation_rad = 0;
};

/// Looks the loops up for one record, which must outlive it. Measured transforms only: the solved poses have no part.
class LoopClosures {
 public:
  explicit LoopClosures(const SurveyRecord& record);
  /// Of the loops with the fewest links the one over the smallest ids; nothing for bridges and links without transform.
  [[nodiscard]] std::optional<LoopClosure> of(const Link& link) const;

 private:
  struct Edge {
    int to = 0;  // index of the scan
    const Link* by = nullptr;
  };
  [[nodiscard]] int index_of(int id) const;  // -1 for scans that the record does not know
  [[nodiscard]] std::vector<const Link*> shortest_path(int from, int to, const Link& without) const;

  const SurveyRecord& record_;
  std::vector<std::vector<Edge>> edges_;  // by index of the scan, ascending ids
};

}  // namespace isthmus::report
