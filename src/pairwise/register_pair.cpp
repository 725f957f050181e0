#include "pairwise/register_pair.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/digest.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "congruent/register.h"
#include "pairwise/generators.h"
#include "pairwise/hypothesis.h"
#include "pairwise/judge.h"
#include "regions/align.h"
#include "regions/grow.h"
#include "regions/overlap_boundary.h"
#include "regions/passers_by.h"

namespace isthmus {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::failed:
      return "failed";
    case Verdict::rejected:
      return "rejected";
    case Verdict::ambiguous:
      return "ambiguous";
    case Verdict::accepted:
      return "accepted";
  }
  return "failed";
}

const config::OptionTable<PairOptions>& pair_options_table() {
  static const config::OptionTable<PairOptions> table{
      "pair",
      "Coarse registration of one pair of scans.",
      {
          {"generators",
           &PairOptions::generators,
           "",
           0,
           0,
           {"axis_votes", "column_votes", "pair_votes", "stem_votes"},
           "Where hypotheses come from: stem_votes = where trunks and posts stand; column_votes = ground plans of all "
           "that "
           "stands upright; axis_votes = matches turned about a common axis of the scene; pair_votes = pairs of "
           "oriented matches, any orientation.",
           "docs/stages/overlap.md"},
          {"matches_per_keypoint",
           &PairOptions::matches_per_keypoint,
           "",
           1,
           48,
           {},
           "Most similar target keypoints that each source keypoint may vote with.",
           "docs/stages/overlap.md"},
          {"vote_window_voxels",
           &PairOptions::vote_window_voxels,
           "voxels",
           5,
           200,
           {},
           "Keypoints this close to a region's centre vote for where the region lies.",
           "docs/stages/overlap.md"},
          {"max_seeds",
           &PairOptions::max_seeds,
           "",
           1,
           100000,
           {},
           "Initial overlapped sub-regions from matches that are grown.",
           "docs/stages/overlap.md"},
          {"max_ranked_seeds",
           &PairOptions::max_ranked_seeds,
           "",
           1,
           100000,
           {},
           "Initial overlaps from columns that are grown.",
           "docs/stages/overlap.md"},
          {"max_hypotheses",
           &PairOptions::max_hypotheses,
           "",
           1,
           100000,
           {},
           "Grown overlaps that are polished and weighed against each other.",
           "docs/stages/overlap.md"},
          {"congruent_hypotheses",
           &PairOptions::congruent_hypotheses,
           "",
           0,
           1000,
           {},
           "Best grown overlaps that Super4PCS registers again from their points alone; 0 = none.",
           "docs/stages/congruent.md"},
          {"fine_hypotheses",
           &PairOptions::fine_hypotheses,
           "",
           1,
           10000,
           {},
           "Best hypotheses that are aligned and weighed again on the finer sampling.",
           "docs/stages/verdict.md"},
          {"congruent_points",
           &PairOptions::congruent_points,
           "",
           50,
           100000,
           {},
           "Points of each grown overlap given to Super4PCS.",
           "docs/stages/congruent.md"},
          {"congruent_bases",
           &PairOptions::congruent_bases,
           "",
           0,
           0,
           {"area", "boundary"},
           "Where Super4PCS takes the corners of its bases: area = anywhere in the grown overlap; boundary = from its "
           "boundary where that holds a base.",
           "docs/stages/congruent.md"},
          {"score_points",
           &PairOptions::score_points,
           "",
           100,
           1000000,
           {},
           "Points of each scan that hypotheses are scored on.",
           "docs/stages/verdict.md"},
          {"accept_probability",
           &PairOptions::accept_probability,
           "",
           0,
           1,
           {},
           "A link is accepted at or above this probability of being right.",
           "docs/stages/verdict.md"},
          {"ambiguous_probability",
           &PairOptions::ambiguous_probability,
           "",
           0,
           1,
           {},
           "Below it a pair is rejected; between the two it is ambiguous.",
           "docs/stages/verdict.md"},
          {"without",
           &PairOptions::without,
           "",
           0,
           0,
           {"growth", "super4pcs", "fine", "rarity", "free_space", "upright", "observed"},
           "Parts of the method left out, for experiments: what does each bring? The last three: of the weighing; "
           "climbing keeps them.",
           "docs/bench.md"},
      }};
  return table;
}

namespace {

// Source points that the hypothesis puts near the target's surface, at most `max_points`: the grown overlap.
std::vector<std::uint32_t> overlap_points(const ScanModel& from, const ScanModel& to, const Transform& to_from,
                                          std::size_t max_points) {
  std::vector<std::uint32_t> all(from.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Pose3f pose = pose3f(to_from);
  const PointVerdicts verdicts = judge_points(from, to, pose, all, true);
  std::vector<std::uint32_t> inside;
  for (const std::uint32_t i : all)
    if (verdicts[i] == PointVerdict::supported) inside.push_back(i);
  if (inside.size() <= max_points) return inside;
  std::vector<std::uint32_t> thinned(max_points);
  for (std::size_t k = 0; k < max_points; ++k) thinned[k] = inside[k * inside.size() / max_points];
  return thinned;
}

struct OverlapCloud {
  std::vector<Eigen::Vector3f> points, normals;
  std::vector<std::uint8_t> at_boundary;
  [[nodiscard]] OrientedCloud view() const { return {points, normals, at_boundary}; }
};

OverlapCloud gathered(const ScanModel& model, std::span<const std::uint32_t> indices) {
  OverlapCloud cloud;
  for (const std::uint32_t i : indices)
    cloud.points.push_back(model.points[i]), cloud.normals.push_back(model.normals[i]);
  return cloud;
}

// Which of `sample` lie where the overlap ends under the hypothesis.
std::vector<std::uint8_t> boundary_marks(const ScanModel& from, const ScanModel& to, const Transform& to_from,
                                         std::span<const std::uint32_t> sample) {
  constexpr float kReachVoxels = 2;  // a dozen neighbours on a surface
  std::vector<std::uint8_t> inside(from.points.size(), 0);
  for (const std::uint32_t i : overlap_points(from, to, to_from, from.points.size())) inside[i] = 1;
  return at_overlap_boundary(from.points, inside, sample, kReachVoxels * from.voxel_m);
}

// Super4PCS on the grown overlap of one hypothesis only.
std::vector<Hypothesis> congruent_hypotheses(const ScanModel& source, const ScanModel& target, const Hypothesis& grown,
                                             const PairOptions& options, std::uint64_t seed) {
  constexpr double kMaxRotationRad = 0.14, kMaxTranslationVoxels = 8;  // what growth may be wrong by
  constexpr int kTrials = 16, kKept = 2;
  const auto points = static_cast<std::size_t>(options.congruent_points);
  const std::vector<std::uint32_t> overlap = overlap_points(source, target, grown.target_from_source, points);
  OverlapCloud from = gathered(source, overlap);
  const OverlapCloud to = gathered(target, overlap_points(target, source, grown.target_from_source.inverse(), points));
  CongruentOptions congruent;
  congruent.max_trials = kTrials;
  congruent.max_transforms = kKept;
  congruent.bases = options.congruent_bases;
  if (congruent.bases == "boundary")
    from.at_boundary = boundary_marks(source, target, grown.target_from_source, overlap);
  CongruentSearch search;
  search.prior = CongruentPrior{grown.target_from_source, kMaxRotationRad,
                                kMaxTranslationVoxels * static_cast<double>(source.voxel_m)};
  const auto result =
      register_congruent(from.view(), to.view(), congruent.tolerance_voxels * static_cast<double>(source.voxel_m), 0.8,
                         seed, congruent, search);
  std::vector<Hypothesis> out;
  for (const ScoredTransform& t : result.transforms) {
    Hypothesis h;
    h.target_from_source = t.target_from_source;
    h.generator = "super4pcs";
    out.push_back(h);
  }
  return out;
}

std::vector<Hypothesis> grown_hypotheses(const ScanModel& source, const ScanModel& target,
                                         const std::vector<Seed>& seeds, bool with_growth) {
  GrowOptions options;
  if (!with_growth) options.final_steps = 0;
  const std::vector<GrownOverlap> grown = grow_all(source, target, seeds, options);
  std::vector<Hypothesis> out(seeds.size());
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    out[k].target_from_source = grown[k].target_from_source;
    out[k].score = static_cast<double>(grown[k].score);
    out[k].generator = seeds[k].generator;
  }
  return out;
}

void polish_all(const ScanModel& source, const ScanModel& target, std::size_t points, int steps,
                std::vector<Hypothesis>& all) {
  parallel_for_index(all.size(), 2, [&](std::size_t k) { polish(source, target, points, steps, all[k]); });
}

// What has climbed on this level stays where it is.
void climb_best(const ScanModel& source, const ScanModel& target, std::vector<Hypothesis>& ranked) {
  constexpr std::size_t kClimbed = 6, kClimbPoints = 700;  // 16 climbed found no more of 57 pairs
  constexpr double kFirstStepVoxels = 1;
  parallel_for_index(std::min(kClimbed, ranked.size()), 1, [&](std::size_t k) {
    if (ranked[k].climbed_on == &source) return;
    climb(source, target, kClimbPoints, kFirstStepVoxels, ranked[k]);
    ranked[k].climbed_on = &source;
  });
}

std::vector<Transform> transforms_of(const std::vector<Hypothesis>& hypotheses) {
  std::vector<Transform> out;
  for (const auto& h : hypotheses) out.push_back(h.target_from_source);
  return out;
}

// Normal equations of the final pose over all points of both scans, as information of the right perturbation.
void fill_information(const ScanModel& source, const ScanModel& target, const Transform& t, PairEvidence& evidence,
                      PairResult& result) {
  constexpr double kPatch = 10;  // neighbouring voxels see the same error: one independent residual in so many
  constexpr double kNoiseFloorVoxels = 0.05;
  std::vector<std::uint32_t> all(source.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Eigen::Vector3d c_source = source.centroid.cast<double>(), centre = t * c_source;
  NormalEquations e;
  add_point_to_plane(source, target, t, all, false, 0.5f * source.voxel_m, centre, e);
  result.rms_m = e.weight > 0 ? std::sqrt(e.sq_residual_sum / e.weight) : 0;
  evidence.rms_voxels = result.rms_m / static_cast<double>(source.voxel_m);
  NormalEquations weighed;  // as the pose was found
  add_point_to_plane(source, target, t, all, false, 0.5f * source.voxel_m, centre, weighed, MatchWeights::by_roughness);
  if (!flat_surfaces_hold(weighed, e)) weighed = e;
  // Of a flat match: what roughness adds to the others is in their weights already.
  const double rms_m = std::sqrt(weighed.sq_residual_sum / std::max(e.weight, 1e-12));
  const double sigma = std::max(rms_m, kNoiseFloorVoxels * static_cast<double>(source.voxel_m));
  Eigen::Matrix3d cross;
  cross << 0, -c_source.z(), c_source.y(), c_source.z(), 0, -c_source.x(), -c_source.y(), c_source.x(), 0;
  Matrix6d m = Matrix6d::Zero();  // (v, w) about the centre in the target frame = m * (translation, rotation) in the
                                  // source frame
  m.topLeftCorner<3, 3>() = t.linear();
  m.topRightCorner<3, 3>() = -t.linear() * cross;
  m.bottomRightCorner<3, 3>() = t.linear();
  const Matrix6d information = m.transpose() * weighed.a * m / (kPatch * sigma * sigma);
  result.information = 0.5 * (information + information.transpose());
  evidence.observability = observability(e);
}

// Residuals in metres, which sensors and tolerances are given in.
void fill_shares(const ScanModel& source, const ScanModel& target, const Transform& t, PairEvidence& evidence) {
  constexpr std::array<float, 2> kBounds = {0.006f, 0.020f};
  constexpr float kMinFacing = 0.5f;
  const Pose3f pose = pose3f(t);
  std::size_t faced = 0;
  std::array<std::size_t, 2> under{};
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const Eigen::Vector3f p = pose.rotation * source.points[i] + pose.translation;
    const std::int32_t j = target.fine.near(p);
    if (j < 0 || target.variation[j] >= 1.0f) continue;
    const Eigen::Vector3f& n = target.normals[j];
    if (n.dot(pose.rotation * source.normals[i]) < kMinFacing) continue;
    ++faced;
    const float residual = std::abs(n.dot(p - target.points[j]));
    for (std::size_t k = 0; k < kBounds.size(); ++k) under[k] += residual < kBounds[k] ? 1 : 0;
  }
  if (faced == 0) return;
  evidence.share_under_6mm = static_cast<double>(under[0]) / static_cast<double>(faced);
  evidence.share_under_20mm = static_cast<double>(under[1]) / static_cast<double>(faced);
}

// The next best pose of the best one's basin, and the best elsewhere. `ranked` is not empty.
void note_rivals(const ScanModel& source, const std::vector<Hypothesis>& ranked, PairEvidence& evidence) {
  const Transform& best = ranked.front().target_from_source;
  bool elsewhere = false;
  for (std::size_t k = 1; k < ranked.size(); ++k) {
    const Transform& other = ranked[k].target_from_source;
    if (same_basin(source, best, other)) {
      evidence.near_score = std::max(evidence.near_score, ranked[k].score);
      continue;
    }
    if (elsewhere) continue;
    elsewhere = true;
    evidence.rival_score = std::max(0.0, ranked[k].score);
    evidence.rival_voxels = displacement_m(best, other, source.centroid.cast<double>()) / source.scan.voxel_m;
    evidence.rival_deg = rotation_angle_rad(best.linear().transpose() * other.linear()) * 180 / std::numbers::pi;
  }
}

// The best poses elsewhere, one of each basin, that explain a share of what the best one explains. `ranked` is not
// empty.
std::vector<RivalPose> rivals_of(const ScanModel& source, const std::vector<Hypothesis>& ranked) {
  std::vector<RivalPose> rivals;
  for (const Hypothesis& h : ranked) {
    if (rivals.size() == kMostRivals || h.score < kLeastRivalShare * ranked.front().score) break;
    const bool known = same_basin(source, ranked.front().target_from_source, h.target_from_source) ||
                       std::ranges::any_of(rivals, [&](const RivalPose& r) {
                         return same_basin(source, r.target_from_source, h.target_from_source);
                       });
    if (!known) rivals.push_back({h.target_from_source, h.score});
  }
  return rivals;
}

// Whether the best pose leaves no need to look further. `ranked` by weigh().
bool decisive(const ScanModel& source, const std::vector<Hypothesis>& ranked) {
  constexpr double kMargin = 3,
                   kScore = 0.12;  // of 570 measured pairs none beyond both was wrong, but for doubtful truths
  constexpr double kMaxContradiction = 0.03;  // of what is in sight
  if (ranked.empty() || ranked.front().score < kScore) return false;
  for (const DirectedEvidence* e : {&ranked.front().source, &ranked.front().target})
    if (e->contradiction > kMaxContradiction * (e->contradiction + e->support)) return false;
  PairEvidence evidence;
  note_rivals(source, ranked, evidence);
  return ranked.front().score > kMargin * evidence.rival_score;
}

// Seeds, growth and weighing of one pair, in rounds that share what was found before.
class PairSearch {
 public:
  PairSearch(const ScanModel& source, const ScanModel& target, const PairOptions& options, Stopwatch& watch,
             std::vector<std::pair<std::string, double>>& counts, PairTrace* trace)
      : source_(source), target_(target), options_(options), watch_(watch), counts_(counts), trace_(trace) {}

  /// The generators that rank their own seeds over whole scans, one after the other, until one settles the pair; then
  /// those that work on matches.
  void run(std::vector<Hypothesis>& hypotheses) {
    std::vector<Seed> waiting;
    for (const Generator& generator : generators()) {
      if (!generator.ranks || !wanted(generator)) continue;
      const std::vector<Seed> seeds = ranked_seeds_of(generator);
      waiting.insert(waiting.end(), seeds.begin(), seeds.end());
      if (!generator.settles(seeds)) continue;
      add(std::exchange(waiting, {}), hypotheses);
      if (decisive(source_, hypotheses)) return;
    }
    const std::vector<Seed> seeds = seeds_of_matches();
    waiting.insert(waiting.end(), seeds.begin(), seeds.end());
    add(waiting, hypotheses);
  }

  /// Poses that somebody proposes, polished like the others.
  std::vector<Hypothesis> hypotheses_of(std::span<const Transform> priors) {
    std::vector<Hypothesis> out(priors.size());
    for (std::size_t k = 0; k < priors.size(); ++k) out[k].target_from_source = priors[k], out[k].generator = "prior";
    polish_all(source_, target_, kPolishPoints, kPolishSteps, out);
    return out;
  }

  /// Super4PCS on the overlaps of the best few.
  void add_congruent(std::uint64_t seed, std::vector<Hypothesis>& hypotheses) {
    const std::size_t count = std::min(hypotheses.size(), static_cast<std::size_t>(options_.congruent_hypotheses));
    if (count == 0) return;
    std::vector<std::vector<Hypothesis>> found(count);
    parallel_for_index(count, 1, [&](std::size_t k) {
      found[k] = congruent_hypotheses(source_, target_, hypotheses[k], options_, seed + k);
    });
    std::vector<Hypothesis> again;
    for (auto& f : found) again.insert(again.end(), f.begin(), f.end());
    polish_all(source_, target_, kPolishPoints, kPolishSteps, again);
    hypotheses.insert(hypotheses.end(), again.begin(), again.end());
    rank(source_, target_, hypotheses);
    counts_.emplace_back("congruent", static_cast<double>(again.size()));
    if (trace_) trace_->congruent = transforms_of(hypotheses);
    watch_.lap("congruent sets");
  }

  /// The best few again on the finer sampling, where only what is right still fits.
  void settle(const ScanModel& fine_source, const ScanModel& fine_target, std::vector<Hypothesis>& hypotheses) {
    if (hypotheses.size() > static_cast<std::size_t>(options_.fine_hypotheses))
      hypotheses.resize(static_cast<std::size_t>(options_.fine_hypotheses));
    polish_all(fine_source, fine_target, 2 * kPolishPoints, kPolishSteps, hypotheses);
    rank(fine_source, fine_target, hypotheses);
    climb_best(fine_source, fine_target, hypotheses);
    rank(fine_source, fine_target, hypotheses);
    if (trace_) trace_->fine = transforms_of(hypotheses);
    watch_.lap("fine weighing");
  }

 private:
  static constexpr std::size_t kPolishPoints = 1200;
  static constexpr int kPolishSteps = 6;

  [[nodiscard]] bool wanted(const Generator& generator) const {
    return std::ranges::find(options_.generators, generator.name) != options_.generators.end();
  }

  // Distinct ones, best first.
  std::vector<Seed> distinct(std::vector<Seed> seeds, int most) {
    constexpr float kSeedDistanceVoxels = 3, kSeedAngleRad = 0.1f;
    seeds = best_distinct_seeds(source_, std::move(seeds), kSeedDistanceVoxels * source_.voxel_m, kSeedAngleRad,
                                static_cast<std::size_t>(most));
    if (trace_)
      for (const Seed& s : seeds) trace_->seeds.push_back(transform_of(s.target_from_source(source_)));
    watch_.lap("seeds");
    return seeds;
  }

  std::vector<Seed> ranked_seeds_of(const Generator& generator) {
    std::vector<Seed> seeds = generator.propose({source_, target_, {}, options_});
    watch_.lap(std::string(generator.name));
    counts_.emplace_back(generator.name, static_cast<double>(seeds.size()));
    return distinct(std::move(seeds), options_.max_ranked_seeds);
  }

  std::vector<Seed> seeds_of_matches() {
    constexpr std::uint32_t kMatchesKept = 48;  // before the axis test; matches_per_keypoint after it
    const MatchTable matches = match_descriptors(source_.features, target_.features, kMatchesKept);
    watch_.lap("matching");
    std::vector<Seed> seeds;
    for (const Generator& generator : generators()) {
      if (generator.ranks || !wanted(generator)) continue;
      const auto more = generator.propose({source_, target_, matches, options_});
      seeds.insert(seeds.end(), more.begin(), more.end());
      watch_.lap(std::string(generator.name));
    }
    counts_.emplace_back("seeds", static_cast<double>(seeds.size()));
    score_seeds(source_, target_, {}, seeds);
    return distinct(std::move(seeds), options_.max_seeds);
  }

  // Grows the seeds, polishes what is new and weighs it against what is there.
  void add(const std::vector<Seed>& seeds, std::vector<Hypothesis>& hypotheses) {
    const double voxel = source_.scan.voxel_m;
    std::vector<Hypothesis> grown = grown_hypotheses(source_, target_, seeds, !options_.leaves_out("growth"));
    keep_distinct(source_, voxel, grown);
    if (grown.size() > static_cast<std::size_t>(options_.max_hypotheses))
      grown.resize(static_cast<std::size_t>(options_.max_hypotheses));
    if (trace_)
      for (const Hypothesis& h : grown) trace_->grown.push_back(h.target_from_source);
    watch_.lap("growth");
    polish_all(source_, target_, kPolishPoints, kPolishSteps, grown);
    hypotheses.insert(hypotheses.end(), grown.begin(), grown.end());
    rank(source_, target_, hypotheses);
    climb_best(source_, target_, hypotheses);
    rank(source_, target_, hypotheses);
    if (trace_) trace_->polished = transforms_of(hypotheses);
    watch_.lap("weighing");
  }

  // Weighed, twins dropped, and weighed again: the share that supports a point is among distinct poses.
  void rank(const ScanModel& source, const ScanModel& target, std::vector<Hypothesis>& hypotheses) const {
    const Weighing weighing{static_cast<std::size_t>(options_.score_points), !options_.leaves_out("rarity"),
                            !options_.leaves_out("free_space"), !options_.leaves_out("upright"),
                            !options_.leaves_out("observed")};
    weigh(source, target, weighing, hypotheses);
    const std::size_t before = hypotheses.size();
    keep_distinct(source, 2 * source.scan.voxel_m, hypotheses);
    if (hypotheses.size() != before) weigh(source, target, weighing, hypotheses);
  }

  const ScanModel& source_;
  const ScanModel& target_;
  const PairOptions& options_;
  Stopwatch& watch_;
  std::vector<std::pair<std::string, double>>& counts_;
  PairTrace* trace_;
};

// Shares of all points of `from`; of those in seen-through space without people that walked on.
DirectedScore score_without_passers_by(const ScanModel& from, const ScanModel& to, const Pose3f& to_from) {
  std::vector<std::uint32_t> all(from.points.size()), contradicted;
  std::iota(all.begin(), all.end(), 0U);
  const PointVerdicts verdicts = judge_points(from, to, to_from, all, false);
  DirectedScore score = shares_of(verdicts);
  if (score.contradiction == 0) return score;
  for (const std::uint32_t i : all)
    if (verdicts[i] == PointVerdict::contradicted) contradicted.push_back(i);
  score.contradiction -= static_cast<float>(num_of_passers_by(from, contradicted)) / static_cast<float>(all.size());
  return score;
}

// Overlap and contradiction of a pose over all points of both scans.
struct BothWays {
  double of_source = 0, of_target = 0, contradiction = 0, against = 0;
  [[nodiscard]] double overlap() const { return std::min(of_source, of_target); }
};
BothWays both_ways(const ScanModel& source, const ScanModel& target, const Transform& target_from_source) {
  const Pose3f pose = pose3f(target_from_source);
  const DirectedScore forward = score_without_passers_by(source, target, pose);
  const DirectedScore backward = score_without_passers_by(target, source, pose.inverse());
  return {static_cast<double>(forward.support), static_cast<double>(backward.support),
          static_cast<double>(std::max(forward.contradiction, backward.contradiction)),
          static_cast<double>(std::max(forward.against, backward.against))};
}

// What a pair is judged on: two levels of both scans.
struct Models {
  const ScanModel &source, &target, &fine_source, &fine_target;
};

// The first of `ranked`, polished to the end and judged. It is not empty.
void assess(const Models& models, const std::vector<Hypothesis>& ranked, const PairOptions& options, double passed_over,
            PairResult& result) {
  constexpr std::size_t kFinalPoints = 20000;
  constexpr int kFinalSteps = 5;
  const auto& [source, target, fine_source, fine_target] = models;
  Hypothesis best = ranked.front();
  polish_closely_unless_worse(fine_source, fine_target, kFinalPoints, kFinalSteps, best);
  const BothWays shares = both_ways(source, target, best.target_from_source);
  result.target_from_source = best.target_from_source;
  result.overlap_of_source = shares.of_source;
  result.overlap_of_target = shares.of_target;
  result.overlap = shares.overlap();
  PairEvidence evidence;
  evidence.score = best.score;
  evidence.passed_over = passed_over;
  note_rivals(source, ranked, evidence);
  result.rivals = rivals_of(source, ranked);
  evidence.support = std::min(best.source.support, best.target.support);
  evidence.rare_support = std::min(best.source.rare_support, best.target.rare_support);
  evidence.contradiction = shares.contradiction;
  evidence.against = shares.against;
  evidence.num_supported = std::min(best.source.support * static_cast<double>(source.points.size()),
                                    best.target.support * static_cast<double>(target.points.size()));
  evidence.free_space = source.scan.free_space.size > 0 || target.scan.free_space.size > 0;
  fill_information(fine_source, fine_target, best.target_from_source, evidence, result);
  fill_shares(fine_source, fine_target, best.target_from_source, evidence);
  judge(evidence, options, result);
}

// Puts in front the best of `ranked` that free space does not speak against, if it comes first once those before it
// have lost what free space says against them; their scores stay divided. False, and all as before, if there is none or
// if it is a twin of the first.
bool pass_over_forbidden(const Models& models, std::vector<Hypothesis>& ranked) {
  const auto discount_of = [&](const Hypothesis& h) {
    const BothWays shares = both_ways(models.source, models.target, h.target_from_source);
    return free_space_discount(shares.overlap(), shares.contradiction);
  };
  std::vector<double> discounts{discount_of(ranked.front())};
  const double least = ranked.front().score / discounts.front();
  while (discounts.back() > 1) {
    const std::size_t next = discounts.size();
    if (next == ranked.size() || ranked[next].score < least) return false;
    discounts.push_back(discount_of(ranked[next]));
  }
  const std::size_t winner = discounts.size() - 1;
  if (same_basin(models.source, ranked.front().target_from_source, ranked[winner].target_from_source)) return false;
  for (std::size_t k = 0; k < winner; ++k) ranked[k].score /= discounts[k];
  const auto first = ranked.begin(), at = first + static_cast<std::ptrdiff_t>(winner);
  std::rotate(first, at, at + 1);
  std::stable_sort(first + 1, ranked.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  return true;
}

PairResult rejected(PairResult result, std::string reason) {
  result.verdict = Verdict::rejected;
  result.reason = std::move(reason);
  return result;
}

std::uint64_t pair_seed(const ScanProduct& source, const ScanProduct& target) {
  Digest digest;
  for (const auto* s : {&source.sampled, &target.sampled})
    digest.add_bytes(s->points.data(), s->points.size() * sizeof(Eigen::Vector3f));
  return digest.value64();
}

}  // namespace

PairResult register_pair(const ScanProduct& source_product, const ScanProduct& target_product,
                         const PairOptions& options, std::span<const Transform> priors, PairTrace* trace) {
  PairResult result;
  if (source_product.sampled.voxel_m != target_product.sampled.voxel_m) {
    result.reason = fmt::format("the scans were sampled with different voxels, {:.4g} m and {:.4g} m",
                                source_product.sampled.voxel_m, target_product.sampled.voxel_m);
    return result;
  }
  Stopwatch watch(result.seconds_by_stage);
  const ScanModel source(source_product.sampled, source_product.features, source_product.regions, ModelLevel::coarse,
                         &source_product.uprights);
  const ScanModel target(target_product.sampled, target_product.features, target_product.regions, ModelLevel::coarse,
                         &target_product.uprights);
  watch.lap("lookups");

  PairSearch search(source, target, options, watch, result.counts, trace);
  std::vector<Hypothesis> hypotheses = search.hypotheses_of(priors);
  search.run(hypotheses);
  result.counts.emplace_back("hypotheses", static_cast<double>(hypotheses.size()));
  if (hypotheses.empty()) return rejected(std::move(result), "no hypothesis: the scans share no matching regions");
  if (!options.leaves_out("super4pcs")) search.add_congruent(pair_seed(source_product, target_product), hypotheses);

  const ModelLevel level = options.leaves_out("fine") ? ModelLevel::coarse : ModelLevel::fine;
  const ScanModel fine_source(source_product.sampled, source_product.features, source_product.regions, level);
  const ScanModel fine_target(target_product.sampled, target_product.features, target_product.regions, level);
  search.settle(fine_source, fine_target, hypotheses);
  const Models models{source, target, fine_source, fine_target};
  assess(models, hypotheses, options, 0, result);
  const double best_score = hypotheses.front().score;
  if (!options.leaves_out("free_space") && forbidden_by_free_space(result) && pass_over_forbidden(models, hypotheses))
    assess(models, hypotheses, options, best_score, result);
  watch.lap("verdict");
  return result;
}

}  // namespace isthmus
