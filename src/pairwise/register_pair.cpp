#include "pairwise/register_pair.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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

namespace isthmus {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::failed: return "failed";
    case Verdict::rejected: return "rejected";
    case Verdict::ambiguous: return "ambiguous";
    case Verdict::accepted: return "accepted";
  }
  return "failed";
}

const config::OptionTable<PairOptions>& pair_options_table() {
  static const config::OptionTable<PairOptions> table{
      "pair",
      "Coarse registration of one pair of scans.",
      {
          {"generators", &PairOptions::generators, "", 0, 0, {"axis_votes", "pair_votes"},
           "Where hypotheses come from: axis_votes = matches turned about a common axis of the scene; pair_votes = pairs of "
           "oriented matches, any orientation.",
           "docs/stages/overlap.md"},
          {"matches_per_keypoint", &PairOptions::matches_per_keypoint, "", 1, 48, {},
           "Most similar target keypoints that each source keypoint may vote with.", "docs/stages/overlap.md"},
          {"vote_window_voxels", &PairOptions::vote_window_voxels, "voxels", 5, 200, {},
           "Keypoints this close to a region's centre vote for where the region lies.", "docs/stages/overlap.md"},
          {"max_seeds", &PairOptions::max_seeds, "", 1, 100000, {},
           "Initial overlapped sub-regions that are grown.", "docs/stages/overlap.md"},
          {"max_hypotheses", &PairOptions::max_hypotheses, "", 1, 100000, {},
           "Grown overlaps that are polished and weighed against each other.", "docs/stages/overlap.md"},
          {"congruent_hypotheses", &PairOptions::congruent_hypotheses, "", 0, 1000, {},
           "Best grown overlaps that Super4PCS registers again from their points alone; 0 = none.",
           "docs/stages/congruent.md"},
          {"fine_hypotheses", &PairOptions::fine_hypotheses, "", 1, 10000, {},
           "Best hypotheses that are aligned and weighed again on the finer sampling.", "docs/stages/verdict.md"},
          {"congruent_points", &PairOptions::congruent_points, "", 50, 100000, {},
           "Points of each grown overlap given to Super4PCS.", "docs/stages/congruent.md"},
          {"congruent_bases", &PairOptions::congruent_bases, "", 0, 0, {"area", "boundary"},
           "Where Super4PCS takes the corners of its bases: area = anywhere in the grown overlap; boundary = from its "
           "boundary where that holds a base.",
           "docs/stages/congruent.md"},
          {"score_points", &PairOptions::score_points, "", 100, 1000000, {},
           "Points of each scan that hypotheses are scored on.", "docs/stages/verdict.md"},
          {"accept_probability", &PairOptions::accept_probability, "", 0, 1, {},
           "A link is accepted at or above this probability of being right.", "docs/stages/verdict.md"},
          {"ambiguous_probability", &PairOptions::ambiguous_probability, "", 0, 1, {},
           "Below it a pair is rejected; between the two it is ambiguous.", "docs/stages/verdict.md"},
      }};
  return table;
}

namespace {

// Source points that the hypothesis puts near the target's surface, at most `max_points`: the grown overlap.
std::vector<std::uint32_t> overlap_points(const ScanModel& from, const ScanModel& to, const Transform& to_from,
                                          std::size_t max_points) {
  std::vector<std::uint32_t> all(from.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Pose3f pose{to_from.linear().cast<float>(), to_from.translation().cast<float>()};
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
  for (const std::uint32_t i : indices) cloud.points.push_back(model.points[i]), cloud.normals.push_back(model.normals[i]);
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
  search.prior = CongruentPrior{grown.target_from_source, kMaxRotationRad, kMaxTranslationVoxels * static_cast<double>(source.voxel_m)};
  const auto result = register_congruent(from.view(), to.view(), congruent.tolerance_voxels * static_cast<double>(source.voxel_m),
                                         0.8, seed, congruent, search);
  std::vector<Hypothesis> out;
  for (const ScoredTransform& t : result.transforms) {
    Hypothesis h;
    h.target_from_source = t.target_from_source;
    h.generator = "super4pcs";
    out.push_back(h);
  }
  return out;
}

std::vector<Hypothesis> grown_hypotheses(const ScanModel& source, const ScanModel& target, const std::vector<Seed>& seeds) {
  std::vector<Hypothesis> out(seeds.size());
  parallel_for_index(seeds.size(), 4, [&](std::size_t k) {
    const GrownOverlap grown = grow(source, target, seeds[k], {});
    out[k].target_from_source = grown.target_from_source;
    out[k].score = static_cast<double>(grown.score);
    out[k].generator = seeds[k].generator;
  });
  return out;
}

void polish_all(const ScanModel& source, const ScanModel& target, std::size_t points, int steps, std::vector<Hypothesis>& all) {
  parallel_for_index(all.size(), 2, [&](std::size_t k) { polish(source, target, points, steps, all[k]); });
}

std::vector<Transform> transforms_of(const std::vector<Hypothesis>& hypotheses) {
  std::vector<Transform> out;
  for (const auto& h : hypotheses) out.push_back(h.target_from_source);
  return out;
}

// Normal equations of the final pose over all points of both scans, as information of the right perturbation.
void fill_information(const ScanModel& source, const ScanModel& target, const Transform& t, PairEvidence& evidence, PairResult& result) {
  constexpr double kPatch = 10;          // neighbouring voxels see the same error: one independent residual in so many
  constexpr double kNoiseFloorVoxels = 0.05;
  std::vector<std::uint32_t> all(source.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Eigen::Vector3d c_source = source.centroid.cast<double>(), centre = t * c_source;
  NormalEquations e;
  add_point_to_plane(source, target, t, all, false, 0.5f * source.voxel_m, centre, e);
  result.rms_m = e.weight > 0 ? std::sqrt(e.sq_residual_sum / e.weight) : 0;
  evidence.rms_voxels = result.rms_m / static_cast<double>(source.voxel_m);
  const double sigma = std::max(result.rms_m, kNoiseFloorVoxels * static_cast<double>(source.voxel_m));
  Eigen::Matrix3d cross;
  cross << 0, -c_source.z(), c_source.y(), c_source.z(), 0, -c_source.x(), -c_source.y(), c_source.x(), 0;
  Matrix6d m = Matrix6d::Zero();  // (v, w) about the centre in the target frame = m * (translation, rotation) in the source frame
  m.topLeftCorner<3, 3>() = t.linear();
  m.topRightCorner<3, 3>() = -t.linear() * cross;
  m.bottomRightCorner<3, 3>() = t.linear();
  const Matrix6d information = m.transpose() * e.a * m / (kPatch * sigma * sigma);
  result.information = 0.5 * (information + information.transpose());
  const Eigen::Vector3d stiffness =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(e.a.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly).eigenvalues();
  evidence.observability = stiffness[2] > 0 ? std::max(0.0, stiffness[0]) / stiffness[2] : 0;
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

PairResult register_pair(const ScanProduct& source_product, const ScanProduct& target_product, const PairOptions& options,
                         std::span<const Transform> priors, PairTrace* trace) {
  PairResult result;
  if (source_product.sampled.voxel_m != target_product.sampled.voxel_m) {
    result.reason = fmt::format("the scans were sampled with different voxels, {:.4g} m and {:.4g} m",
                                source_product.sampled.voxel_m, target_product.sampled.voxel_m);
    return result;
  }
  Stopwatch watch(result.seconds_by_stage);
  const ScanModel source(source_product.sampled, source_product.features, source_product.regions, ModelLevel::coarse);
  const ScanModel target(target_product.sampled, target_product.features, target_product.regions, ModelLevel::coarse);
  const double voxel = source_product.sampled.voxel_m;
  watch.lap("lookups");

  constexpr std::uint32_t kMatchesKept = 48;  // before the axis test; matches_per_keypoint after it
  const MatchTable matches = match_descriptors(source.features, target.features, kMatchesKept);
  watch.lap("matching");
  std::vector<Seed> seeds;
  for (const Generator& generator : generators()) {
    if (std::find(options.generators.begin(), options.generators.end(), generator.name) == options.generators.end()) continue;
    const auto more = generator.propose({source, target, matches, options});
    seeds.insert(seeds.end(), more.begin(), more.end());
  }
  result.counts.emplace_back("seeds", static_cast<double>(seeds.size()));
  watch.lap("votes");
  score_seeds(source, target, {}, seeds);
  constexpr float kSeedDistanceVoxels = 3, kSeedAngleRad = 0.1f;
  seeds = best_distinct_seeds(source, std::move(seeds), kSeedDistanceVoxels * source.voxel_m, kSeedAngleRad,
                              static_cast<std::size_t>(options.max_seeds));
  watch.lap("seeds");
  if (trace)
    for (const Seed& s : seeds) {
      Transform t = Transform::Identity();
      const Pose3f pose = s.target_from_source(source);
      t.linear() = pose.rotation.cast<double>(), t.translation() = pose.translation.cast<double>();
      trace->seeds.push_back(t);
    }

  std::vector<Hypothesis> hypotheses = grown_hypotheses(source, target, seeds);
  keep_distinct(source, voxel, hypotheses);
  if (hypotheses.size() > static_cast<std::size_t>(options.max_hypotheses)) hypotheses.resize(static_cast<std::size_t>(options.max_hypotheses));
  if (trace) trace->grown = transforms_of(hypotheses);
  for (const Transform& prior : priors) {
    Hypothesis h;
    h.target_from_source = prior;
    h.generator = "prior";
    hypotheses.push_back(h);
  }
  result.counts.emplace_back("hypotheses", static_cast<double>(hypotheses.size()));
  watch.lap("growth");
  if (hypotheses.empty()) return rejected(std::move(result), "no hypothesis: the scans share no matching regions");

  constexpr std::size_t kPolishPoints = 1200;
  constexpr int kPolishSteps = 6;
  polish_all(source, target, kPolishPoints, kPolishSteps, hypotheses);
  const auto score_points = static_cast<std::size_t>(options.score_points);
  weigh(source, target, score_points, hypotheses);
  keep_distinct(source, 2 * voxel, hypotheses);
  weigh(source, target, score_points, hypotheses);
  if (trace) trace->polished = transforms_of(hypotheses);
  watch.lap("weighing");

  const std::size_t num_congruent = std::min(hypotheses.size(), static_cast<std::size_t>(options.congruent_hypotheses));
  if (num_congruent > 0) {
    const std::uint64_t seed = pair_seed(source_product, target_product);
    std::vector<std::vector<Hypothesis>> found(num_congruent);
    parallel_for_index(num_congruent, 1, [&](std::size_t k) {
      found[k] = congruent_hypotheses(source, target, hypotheses[k], options, seed + k);
    });
    std::vector<Hypothesis> again;
    for (auto& f : found) again.insert(again.end(), f.begin(), f.end());
    polish_all(source, target, kPolishPoints, kPolishSteps, again);
    hypotheses.insert(hypotheses.end(), again.begin(), again.end());
    weigh(source, target, score_points, hypotheses);
    keep_distinct(source, 2 * voxel, hypotheses);
    weigh(source, target, score_points, hypotheses);
    result.counts.emplace_back("congruent", static_cast<double>(again.size()));
  }
  if (trace) trace->congruent = transforms_of(hypotheses);
  watch.lap("congruent sets");

  // The best few again on the finer sampling, where only what is right still fits.
  const ScanModel fine_source(source_product.sampled, source_product.features, source_product.regions, ModelLevel::fine);
  const ScanModel fine_target(target_product.sampled, target_product.features, target_product.regions, ModelLevel::fine);
  if (hypotheses.size() > static_cast<std::size_t>(options.fine_hypotheses)) hypotheses.resize(static_cast<std::size_t>(options.fine_hypotheses));
  polish_all(fine_source, fine_target, 2 * kPolishPoints, kPolishSteps, hypotheses);
  keep_distinct(source, 2 * voxel, hypotheses);
  weigh(fine_source, fine_target, score_points, hypotheses);
  if (trace) trace->fine = transforms_of(hypotheses);
  watch.lap("fine weighing");
  Hypothesis best = hypotheses.front();
  constexpr std::size_t kFinalPoints = 20000;
  polish(fine_source, fine_target, kFinalPoints, 5, best);
  const Pose3f pose{best.target_from_source.linear().cast<float>(), best.target_from_source.translation().cast<float>()};
  const DirectedScore forward = score_direction(source, target, pose, {}, 1, false);
  const DirectedScore backward = score_direction(target, source, pose.inverse(), {}, 1, false);
  result.target_from_source = best.target_from_source;
  result.overlap_of_source = static_cast<double>(forward.support);
  result.overlap_of_target = static_cast<double>(backward.support);
  result.overlap = std::min(result.overlap_of_source, result.overlap_of_target);
  PairEvidence evidence;
  evidence.score = best.score;
  evidence.rival_score = hypotheses.size() > 1 ? std::max(0.0, hypotheses[1].score) : 0.0;
  evidence.support = std::min(best.source.support, best.target.support);
  evidence.rare_support = std::min(best.source.rare_support, best.target.rare_support);
  evidence.contradiction = std::max(static_cast<double>(forward.contradiction), static_cast<double>(backward.contradiction));
  evidence.against = std::max(static_cast<double>(forward.against), static_cast<double>(backward.against));
  evidence.num_supported = std::min(best.source.support * static_cast<double>(source.points.size()),
                                    best.target.support * static_cast<double>(target.points.size()));
  evidence.free_space = source.scan.free_space.size > 0 || target.scan.free_space.size > 0;
  fill_information(fine_source, fine_target, best.target_from_source, evidence, result);
  judge(evidence, options, result);
  watch.lap("verdict");
  return result;
}

}  // namespace isthmus
