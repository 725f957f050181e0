#include "congruent/register.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "base/rng.h"
#include "congruent/refine.h"
#include "congruent/trial.h"

namespace isthmus {
namespace {

using namespace congruent;

constexpr int kTrialsPerBatch = 4;           // trials between two looks at the score: fixed, so threads cannot show
constexpr double kDistinctTolerances = 2;    // transforms closer than this many tolerances are one
constexpr double kCoplanarTolerances = 0.5;  // gap allowed between the diagonals of a base
// Share of trials that lead to the truth: kBaseHit overlap^kCorners. A fit to three synthetic surfaces of 1,400 to
// 3,000 points, where it holds or is exceeded from 60 to 100 % overlap; coarser clouds reach less, so that there the
// confidence is nominal (table in docs/stages/congruent.md). Four independent corners would give overlap^4, but the
// corners of one base lie near each other and leave the overlap together.
constexpr double kBaseHit = 0.7;
constexpr double kCorners = 3;
constexpr int kSpareTransforms = 8;         // kept until refinement has merged some and moved others beyond the prior
constexpr std::size_t kPairsDrawn = 2000;   // a diagonal as common as one pair in a hundred is met twenty times
constexpr std::size_t kCoverSamples = 500;  // the cover of a thinned target is known to 2 %
constexpr double kMostTolerances = 5e5;     // diameter in tolerances that the hash grids can number

// What makes a cloud unusable, by its name; empty if nothing does.
std::string objection(const char* name, const OrientedCloud& cloud, bool use_normals) {
  if (!cloud.at_boundary.empty() && cloud.at_boundary.size() != cloud.points.size())
    return fmt::format("{} has {} points but {} marks of the boundary; give as many or none", name, cloud.points.size(),
                       cloud.at_boundary.size());
  if (!use_normals || cloud.normals.size() == cloud.points.size()) return {};
  return fmt::format("{} has {} points but {} normals; give as many or set use_normals to false", name,
                     cloud.points.size(), cloud.normals.size());
}

std::string objection(const char* name, const LocalCloud& cloud, double tolerance_m) {
  if (cloud.points.size() < 4) return fmt::format("{} has {} usable points; a base needs 4", name, cloud.points.size());
  float farthest_m = 0;
  for (const auto& p : cloud.points) farthest_m = std::max(farthest_m, p.cwiseAbs().maxCoeff());
  if (static_cast<double>(farthest_m) < kMostTolerances * tolerance_m) return {};
  return fmt::format("{} reaches {} m from its middle, beyond {} times the tolerance of {} m", name, farthest_m,
                     kMostTolerances, tolerance_m);
}

std::string objection(double tolerance_m, double overlap) {
  if (!(tolerance_m > 0) || !std::isfinite(tolerance_m))
    return fmt::format("tolerance {} m is not a positive length", tolerance_m);
  if (!(overlap > 0 && overlap <= 1)) return fmt::format("overlap {} is not in (0, 1]", overlap);
  return {};
}

// What is known beforehand, between the recentred frames.
CongruentSearch recentred(const CongruentSearch& search, const LocalCloud& source, const LocalCloud& target) {
  CongruentSearch local = search;
  if (local.prior)
    local.prior->target_from_source =
        Eigen::Translation3d(-target.centre) * search.prior->target_from_source * Eigen::Translation3d(source.centre);
  return local;
}

std::vector<PointPair> draw_pairs(const LocalCloud& cloud, std::size_t count, Rng rng) {
  std::vector<PointPair> pairs(count);
  for (PointPair& pair : pairs) {
    pair.first = static_cast<std::uint32_t>(rng.below(cloud.points.size()));
    pair.second = static_cast<std::uint32_t>(rng.below(cloud.points.size()));
  }
  return pairs;
}

// Share of the whole target that has a point of the thinned one within the tolerance.
double cover(const LocalCloud& whole, const LocalCloud& thin, double tolerance_m, double facing_rad, Rng rng) {
  if (thin.points.size() == whole.points.size()) return 1;
  const ScoreSample sample = draw_sample(whole, kCoverSamples, rng);
  ScoreCounts counts;
  const auto common =
      count_common(FacingGrid(thin, tolerance_m, facing_rad), sample, Transform::Identity(), -1, counts);
  return static_cast<double>(common.value_or(0)) / static_cast<double>(sample.points.size());
}

// Trials until one base had all its corners in the overlap, each with a counterpart, with the wanted confidence.
int trials_for(double confidence, double share_with_counterpart) {
  const double hit = kBaseHit * std::pow(share_with_counterpart, kCorners);
  const double trials = std::ceil(std::log(1 - confidence) / std::log1p(-hit));
  return trials < std::numeric_limits<int>::max() ? static_cast<int>(trials) : std::numeric_limits<int>::max();
}

void add(CongruentCounts& sum, const CongruentCounts& c) {
  sum.trials_without_base += c.trials_without_base;
  sum.trials_too_common += c.trials_too_common;
  sum.cell_tests += c.cell_tests;
  sum.distance_tests += c.distance_tests;
  sum.pairs += c.pairs;
  sum.gap_tests += c.gap_tests;
  sum.congruent_sets += c.congruent_sets;
  sum.transforms_looked_at += c.transforms_looked_at;
  sum.transforms_scored += c.transforms_scored;
  sum.points_looked_up += c.points_looked_up;
}

double share(std::int64_t common, const ScoreSample& sample) {
  return static_cast<double>(common) / static_cast<double>(sample.points.size());
}

BestTransforms no_transforms(const TrialSetting& s) {
  const double least = std::ceil(s.options.min_score * static_cast<double>(s.sample.points.size()));
  return {s.num_kept, s.distinct_m, 0.5 * s.source.diameter_m, static_cast<std::int64_t>(least) - 1};
}

// Batches of trials until the confidence is reached, the score is good enough or the cap is met.
BestTransforms run_trials(const TrialSetting& s, double overlap, double cover_of_target, std::uint64_t seed,
                          CongruentCounts& counts) {
  BestTransforms best = no_transforms(s);
  const auto wanted = [&](double o) { return trials_for(s.options.confidence, o * cover_of_target); };
  counts.trials_wanted = wanted(overlap);
  for (int enough = std::min(counts.trials_wanted, s.options.max_trials); counts.trials < enough;) {
    const int first = counts.trials, num = std::min(kTrialsPerBatch, enough - first);
    std::vector<std::optional<TrialOutcome>> outcomes(static_cast<std::size_t>(num));
    parallel_for_index(outcomes.size(), 1, [&](std::size_t i) {
      const int trial = first + static_cast<int>(i);
      outcomes[i] = run_trial(s, trial, Rng(seed_of(seed, fmt::format("trial {}", trial))), best.to_beat());
    });
    for (const auto& outcome : outcomes) {
      add(counts, outcome->counts);
      for (const CountedTransform& t : outcome->best.kept()) best.add(t);
    }
    counts.trials += num;
    if (best.kept().empty()) continue;
    const double score = share(best.kept().front().common, s.sample);
    if (score >= s.options.stop_score) break;
    if (s.options.stop_votes > 0 && std::ssize(best.kept().front().voters) >= s.options.stop_votes) break;
    enough = std::min(enough, wanted(std::max(overlap, score)));  // the overlap is at least what has been found
  }
  return best;
}

// Each transform pulled onto the surface and scored there: four points may sit on lucky samples, the surface does not.
// Those beyond the prior are left out.
BestTransforms refined(const TrialSetting& s, const BestTransforms& rough, const LocalCloud& whole_target,
                       CongruentCounts& counts) {
  BestTransforms fine = no_transforms(s);
  ScoreCounts score_counts;
  for (CountedTransform t : rough.kept()) {
    t.target_from_source =
        congruent::refined(s.grid, whole_target, s.sample, t.target_from_source, s.options.refine_steps);
    t.common = count_common(s.grid, s.sample, t.target_from_source, -1, score_counts).value_or(0);
    if (!s.search.prior || within(*s.search.prior, t.target_from_source, 0, 0)) fine.add(t);
  }
  counts.points_looked_up += score_counts.points_looked_up;
  return fine;
}

std::string why_empty(const CongruentResult& result, const CongruentOptions& options) {
  const CongruentCounts& c = result.counts;
  if (c.trials_without_base == c.trials)
    return fmt::format("no wide coplanar base in {} trials: the source is too small, a line or too sparse", c.trials);
  if (c.trials_without_base + c.trials_too_common == c.trials)
    return fmt::format(
        "every base was too common: more than {} pairs or {} congruent sets (raise max_pairs and "
        "max_congruent_sets, or thin the clouds)",
        options.max_pairs, options.max_congruent_sets);
  if (c.transforms_scored == 0) return fmt::format("no base of {} trials has a congruent set in the target", c.trials);
  return fmt::format("none of {} transforms brings {} of the source onto the target within the bounds given",
                     c.transforms_scored, options.min_score);
}

}  // namespace

CongruentResult register_congruent(const OrientedCloud& source_cloud, const OrientedCloud& target_cloud,
                                   double tolerance_m, double overlap, std::uint64_t seed,
                                   const CongruentOptions& options, const CongruentSearch& search) {
  CongruentResult result;
  const auto refused = [&](std::string objection) {
    result.reason = std::move(objection);
    return !result.reason.empty();
  };
  if (refused(objection(tolerance_m, overlap)) || refused(objection("source", source_cloud, options.use_normals)) ||
      refused(objection("target", target_cloud, options.use_normals)))
    return result;
  const LocalCloud source = congruent::recentred(source_cloud, options.use_normals);
  const LocalCloud target = congruent::recentred(target_cloud, options.use_normals);
  if (refused(objection("source", source, tolerance_m)) || refused(objection("target", target, tolerance_m)))
    return result;

  const double facing_rad = options.facing_tolerance_deg * std::numbers::pi / 180;
  const LocalCloud thin =
      thinned_by_lot(thinned_by_cells(target, options.thinning_tolerances * tolerance_m),
                     static_cast<std::size_t>(options.max_target_points), Rng(seed_of(seed, "thin")));
  Rng sample_rng(seed_of(seed, "sample"));
  const ScoreSample sample = draw_sample(source, static_cast<std::size_t>(options.score_samples), sample_rng);
  const FacingGrid grid(target, tolerance_m, facing_rad);
  const PairIndex pairs(thin.points, thin.normals);
  const auto source_pairs = draw_pairs(source, kPairsDrawn, Rng(seed_of(seed, "pairs")));
  const CongruentSearch local_search = recentred(search, source, target);
  const TrialSetting setting{.source = source,
                             .target = thin,
                             .pairs = pairs,
                             .grid = grid,
                             .sample = sample,
                             .source_pairs = source_pairs,
                             .search = local_search,
                             .options = options,
                             .tolerance_m = tolerance_m,
                             .wish = {.width_m = options.base_width * overlap * source.diameter_m,
                                      .coplanarity_m = kCoplanarTolerances * tolerance_m,
                                      .at_boundary = options.bases == "boundary"},
                             .distinct_m = kDistinctTolerances * tolerance_m,
                             .num_kept = static_cast<std::size_t>(options.max_transforms + kSpareTransforms)};

  const double cover_of_target = cover(target, thin, tolerance_m, facing_rad, Rng(seed_of(seed, "cover")));
  const BestTransforms rough = run_trials(setting, overlap, cover_of_target, seed, result.counts);
  const BestTransforms fine = refined(setting, rough, target, result.counts);
  for (const CountedTransform& t : fine.kept()) {
    if (std::ssize(result.transforms) == options.max_transforms) break;
    result.transforms.push_back(
        {Eigen::Translation3d(target.centre) * t.target_from_source * Eigen::Translation3d(-source.centre),
         share(t.common, sample), t.trial, static_cast<int>(t.voters.size())});
  }
  if (result.transforms.empty()) result.reason = why_empty(result, options);
  return result;
}

}  // namespace isthmus
