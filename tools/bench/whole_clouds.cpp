#include "bench/whole_clouds.h"

#include "base/rng.h"
#include "bench/processor_time.h"
#include "congruent/register.h"

namespace isthmus::bench {

PairTrial run_whole_clouds(const BenchSet& set, std::size_t source_index, std::size_t target_index,
                           const WholeClouds& options) {
  const BenchScan &source = set.scans[source_index], &target = set.scans[target_index];
  PairTrial trial = trial_of(set, source_index, target_index);
  const SampledScan &from = source.product.sampled, &to = target.product.sampled;
  CongruentOptions congruent;
  congruent.max_trials = options.max_trials;
  const double start = thread_cpu_seconds();
  const CongruentResult found = register_congruent({from.points, from.normals, {}}, {to.points, to.normals, {}},
                                                   congruent.tolerance_voxels * from.voxel_m, options.overlap,
                                                   seed_of(seed_of(1, source.name), target.name), congruent);
  trial.cpu_s = thread_cpu_seconds() - start;
  trial.result.reason = found.reason.empty() ? "gives no verdict" : found.reason;
  if (!found.transforms.empty()) {
    trial.result.target_from_source = found.transforms.front().target_from_source;
    trial.result.overlap = found.transforms.front().score;
  }
  const PairTruth truth = truth_of(set, source_index, target_index);
  compare(truth, trial);
  for (std::size_t k = 0; k < found.transforms.size() && trial.rank.back() == 0; ++k)
    if (truth.is_right(found.transforms[k].target_from_source)) trial.rank.back() = static_cast<int>(k) + 1;
  return trial;
}

}  // namespace isthmus::bench
