#include "bench/pair_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/processor_time.h"
#include "pairwise/hypothesis.h"
#include "pipelines/frames.h"
#include "regions/overlap_score.h"

namespace isthmus::bench {
namespace {

constexpr double kRightDeg = 2, kRightVoxels = 2;
constexpr double kNearDeg = 10;

// Mean of the source points that the true pose puts on the target's surface; the centroid where there are none.
Eigen::Vector3d middle_of_overlap(const ScanModel& source, const ScanModel& target, const Transform& truth) {
  std::vector<std::uint32_t> all(source.points.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const Pose3f pose = pose3f(truth);
  const PointVerdicts verdicts = judge_points(source, target, pose, all, false);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t n = 0;
  for (const std::uint32_t i : all)
    if (verdicts[i] == PointVerdict::supported) sum += source.points[i].cast<double>(), ++n;
  return n > 0 ? Eigen::Vector3d(sum / static_cast<double>(n)) : Eigen::Vector3d(source.centroid.cast<double>());
}

template <class Test>
int first_rank(const std::vector<Transform>& list, const Test& is_true) {
  const auto found = std::find_if(list.begin(), list.end(), is_true);
  return found == list.end() ? 0 : static_cast<int>(found - list.begin()) + 1;
}

struct Band {
  const char* name;
  double low, high;
};
constexpr Band kBands[] = {{"above 30 %", 0.3, 2}, {"20-30 %", 0.2, 0.3},   {"10-20 %", 0.1, 0.2},
                           {"5-10 %", 0.05, 0.1},  {"below 5 %", -1, 0.05}, {"all", -1, 2}};

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

std::string cell_of_ranks(const std::vector<const PairTrial*>& trials, std::size_t stage) {
  std::array<int, 3> within{};
  constexpr std::array<int, 3> kRanks{1, 10, 100};
  for (const PairTrial* t : trials)
    for (std::size_t k = 0; k < kRanks.size(); ++k) within[k] += t->rank[stage] > 0 && t->rank[stage] <= kRanks[k];
  return fmt::format("{}/{}/{}", within[0], within[1], within[2]);
}

}  // namespace

double PairTruth::rotation_deg(const Transform& t) const {
  return rotation_angle_rad((target_from_source.inverse() * t).linear()) * 180 / std::numbers::pi;
}

double PairTruth::translation_m(const Transform& t) const {
  return (target_from_source.inverse() * t * centroid - centroid).norm();
}

bool PairTruth::is_right(const Transform& t) const {
  return rotation_deg(t) < kRightDeg && translation_m(t) < kRightVoxels * voxel_m;
}

PairTruth truth_of(const BenchSet& set, std::size_t source_index, std::size_t target_index) {
  const BenchScan &source = set.scans[source_index], &target = set.scans[target_index];
  const Eigen::Vector3d origin = source.product.sampled.local_origin_in_scan;
  PairTruth truth;
  truth.target_from_source = pipelines::between_scan_frames(target.common_from_scan.inverse() * source.common_from_scan,
                                                            -origin, -target.product.sampled.local_origin_in_scan);
  truth.centroid = source.centroid - origin;
  truth.voxel_m = set.evaluation_voxel_m;
  return truth;
}

PairTrial trial_of(const BenchSet& set, std::size_t source, std::size_t target) {
  PairTrial trial;
  trial.set = set.name, trial.source = set.scans[source].name, trial.target = set.scans[target].name;
  const auto key = std::minmax(source, target);
  trial.overlap = set.overlap.at({key.first, key.second});
  return trial;
}

void compare(const PairTruth& truth, PairTrial& trial) {
  if (!trial.result.target_from_source) return;
  trial.rotation_deg = truth.rotation_deg(*trial.result.target_from_source);
  trial.translation_m = truth.translation_m(*trial.result.target_from_source);
  trial.right = truth.is_right(*trial.result.target_from_source);
}

PairTrial run_trial(const BenchSet& set, std::size_t source_index, std::size_t target_index,
                    const PairOptions& options) {
  const BenchScan &source = set.scans[source_index], &target = set.scans[target_index];
  PairTrial trial = trial_of(set, source_index, target_index);
  PairTrace trace;
  const double start = thread_cpu_seconds();
  trial.result = register_pair(source.product, target.product, options, {}, &trace);
  trial.cpu_s = thread_cpu_seconds() - start;
  const PairTruth known = truth_of(set, source_index, target_index);
  const Transform& truth = known.target_from_source;
  const double voxel = source.product.sampled.voxel_m;
  compare(known, trial);
  const ScanModel from(source.product.sampled, source.product.features, source.product.regions, ModelLevel::coarse);
  const ScanModel to(target.product.sampled, target.product.features, target.product.regions, ModelLevel::coarse);
  const Eigen::Vector3d middle = middle_of_overlap(from, to, truth);
  const auto is_near = [&](const Transform& t) {
    const Transform d = truth.inverse() * t;
    return (d * middle - middle).norm() < kNearVoxels * voxel &&
           rotation_angle_rad(d.linear()) * 180 / std::numbers::pi < kNearDeg;
  };
  const auto right = [&](const Transform& t) { return known.is_right(t); };
  trial.rank = {first_rank(trace.seeds, is_near), first_rank(trace.grown, is_near), first_rank(trace.polished, right),
                first_rank(trace.congruent, right), first_rank(trace.fine, right)};
  if (trial.result.target_from_source) {
    const ScanModel fine_from(source.product.sampled, source.product.features, source.product.regions,
                              ModelLevel::fine);
    const ScanModel fine_to(target.product.sampled, target.product.features, target.product.regions, ModelLevel::fine);
    const auto weighed = [&](const Transform& t) {
      std::vector<Hypothesis> alone(1);
      alone[0].target_from_source = t;
      weigh(fine_from, fine_to, {static_cast<std::size_t>(options.score_points), false, true}, alone);
      return alone[0];
    };
    const Hypothesis at_truth = weighed(truth), at_best = weighed(*trial.result.target_from_source);
    trial.truth_score = at_truth.score, trial.best_score = at_best.score;
    trial.truth_support = std::min(at_truth.source.support, at_truth.target.support);
    trial.best_support = std::min(at_best.source.support, at_best.target.support);
  }
  return trial;
}

std::string csv_of(const std::vector<PairTrial>& trials) {
  std::string text = "set,source,target,overlap,right,rotation_deg,translation_m";
  for (const char* stage : kTracedStages) text += fmt::format(",rank_{}", stage);
  text += ",truth_score,best_score,truth_support,best_support,verdict,probability,estimated_overlap,rms_m,cpu_s";
  // Failed pairs carry no evidence, settled ones not every stage: the columns are those of all trials, as they come.
  std::vector<std::string> evidence, stages;
  const auto collect = [](const auto& list, std::vector<std::string>& names) {
    for (const auto& [name, value] : list)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const PairTrial& t : trials) collect(t.result.evidence, evidence), collect(t.result.seconds_by_stage, stages);
  for (const std::string& name : evidence) text += fmt::format(",{}", name);
  for (const std::string& name : stages) text += fmt::format(",s_{}", name);
  text += "\n";
  for (const PairTrial& t : trials) {
    text += fmt::format("{},{},{},{:.4f},{},{:.4f},{:.5f}", t.set, t.source, t.target, t.overlap, t.right ? 1 : 0,
                        t.rotation_deg, t.translation_m);
    for (const int rank : t.rank) text += fmt::format(",{}", rank);
    text += fmt::format(",{:.4f},{:.4f},{:.4f},{:.4f}", t.truth_score, t.best_score, t.truth_support, t.best_support);
    text += fmt::format(",{},{:.5f},{:.4f},{:.5g},{:.4f}", to_string(t.result.verdict), t.result.probability,
                        t.result.overlap, t.result.rms_m, t.cpu_s);
    const auto sum_in = [](const auto& list, const std::string& name) {  // a stage may run twice
      double sum = 0;
      bool found = false;
      for (const auto& [key, value] : list)
        if (key == name) sum += value, found = true;
      return found ? fmt::format(",{:.6g}", sum) : fmt::format(",");
    };
    for (const std::string& name : evidence) text += sum_in(t.result.evidence, name);
    for (const std::string& name : stages) text += sum_in(t.result.seconds_by_stage, name);
    text += "\n";
  }
  return text;
}

std::string table_of(const std::vector<PairTrial>& trials) {
  std::string text = "| overlap | pairs | right | accepted | accepted wrongly |";
  for (const char* stage : kTracedStages) text += fmt::format(" {} 1/10/100 |", stage);
  text += " cpu s median | cpu s 95 % | cpu s most |\n|---|---|---|---|---|";
  for (std::size_t k = 0; k < kTracedStages.size() + 3; ++k) text += "---|";
  text += "\n";
  for (const Band& band : kBands) {
    std::vector<const PairTrial*> in;
    for (const PairTrial& t : trials)
      if (t.overlap > band.low && t.overlap <= band.high) in.push_back(&t);
    if (in.empty()) continue;
    int right = 0, accepted = 0, wrong = 0;
    std::vector<double> seconds;
    for (const PairTrial* t : in) {
      const bool yes = t->result.verdict == Verdict::accepted;
      right += t->right, accepted += yes, wrong += yes && !t->right;
      seconds.push_back(t->cpu_s);
    }
    text += fmt::format("| {} | {} | {} ({:.0f} %) | {} | {} |", band.name, in.size(), right,
                        100.0 * right / static_cast<double>(in.size()), accepted, wrong);
    for (std::size_t stage = 0; stage < kTracedStages.size(); ++stage)
      text += fmt::format(" {} |", cell_of_ranks(in, stage));
    text += fmt::format(" {:.2f} | {:.2f} | {:.2f} |\n", quantile(seconds, 0.5), quantile(seconds, 0.95),
                        quantile(seconds, 1));
  }
  return text;
}

}  // namespace isthmus::bench
