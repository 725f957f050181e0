// One pair of a set, registered, and where the truth stood after each stage.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_set.h"

namespace isthmus::bench {

/// The stages after which hypotheses are listed, best first (PairTrace).
inline constexpr std::array<const char*, 5> kTracedStages{"regions", "growth", "weighing", "super4pcs", "fine"};

struct PairTrial {
  std::string set, source, target;
  double overlap = 0;
  double rotation_deg = 180;  ///< of the best hypothesis; 180 without one
  double translation_m = 0;   ///< at the source's centroid
  bool right = false;         ///< within 2 degrees and 2 evaluation voxels
  /// Place of the first true hypothesis after each stage, from 1; 0 = none. After regions and growth a hypothesis is
  /// true when it moves the truly overlapping points by less than kNearVoxels, later when it is right.
  std::array<int, kTracedStages.size()> rank{};
  /// Score (without rarity) and support of the true and of the best pose on the fine level: where the truth scores
  /// lower, better proposals would not have helped.
  double truth_score = 0, best_score = 0;
  double truth_support = 0, best_support = 0;
  double cpu_s = 0;  ///< processor time of the pair stage, features not included
  PairResult result;
};

inline constexpr double kNearVoxels = 5;  ///< sampling voxels that growth is expected to bridge

/// What the ground truth says about a pair, between the local frames of its products.
struct PairTruth {
  Transform target_from_source = Transform::Identity();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< of the source: where translations are compared
  double voxel_m = 0;                                  ///< of the evaluation
  [[nodiscard]] double rotation_deg(const Transform& t) const;
  [[nodiscard]] double translation_m(const Transform& t) const;
  [[nodiscard]] bool is_right(const Transform& t) const;  ///< within 2 degrees and 2 evaluation voxels
};
PairTruth truth_of(const BenchSet& set, std::size_t source, std::size_t target);

/// Names and overlap of a pair that was not registered yet.
PairTrial trial_of(const BenchSet& set, std::size_t source, std::size_t target);
/// Fills the errors of the best hypothesis, if there is one.
void compare(const PairTruth& truth, PairTrial& trial);

PairTrial run_trial(const BenchSet& set, std::size_t source, std::size_t target, const PairOptions& options);

/// A header and a row per trial, RFC 4180; seconds by stage and evidence in columns of their own.
std::string csv_of(const std::vector<PairTrial>& trials);

/// For each band of overlap: pairs, right ones, ranks, verdicts, seconds. For people and for docs (Markdown).
std::string table_of(const std::vector<PairTrial>& trials);

}  // namespace isthmus::bench
