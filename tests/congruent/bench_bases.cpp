// Bases from the area of an overlap against bases from its boundary, on the synthetic surfaces with the overlap known
// up to an error. One thread. Prints a table in Markdown; docs/stages/congruent.md quotes it.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "congruent/register.h"
#include "congruent/synthetic.h"

namespace {

using namespace isthmus;
using namespace isthmus::congruent;

constexpr int kRuns = 30;
constexpr double kSpacing = 0.15, kTolerance = 1.5 * kSpacing, kNoise = 0.01, kNormalNoise = 0.08;
constexpr double kRim = 2 * kSpacing;  // how wide the boundary is
constexpr double kEnd = 1.5;           // half the length of the overlap
constexpr double kOverlapGiven = 0.8;  // as the pair stage says

using Sample = test::Cloud (*)(double, double, double, std::uint64_t, double, double);

struct Scene {
  test::Cloud source, target;
  std::vector<std::uint8_t> at_boundary;
  Transform target_from_source;
};

// The source is what is believed to be the overlap: `excess_m` too long at either end; the target ends where it ends.
Scene scene_of(Sample sample, double excess_m, std::uint64_t seed) {
  Rng rng(seed);
  const Transform source_from_world = test::random_transform(rng, 20),
                  target_from_world = test::random_transform(rng, 20);
  const double end = kEnd + excess_m;
  const test::Cloud source = sample(kSpacing, kNoise, kNormalNoise, 2 * seed, -end, end);
  Scene scene{test::moved(source, source_from_world),
              test::moved(sample(kSpacing, kNoise, kNormalNoise, 2 * seed + 1, -kEnd, kEnd), target_from_world),
              {},
              target_from_world * source_from_world.inverse()};
  for (const auto& p : source.points) scene.at_boundary.push_back(std::abs(static_cast<double>(p.x())) > end - kRim);
  return scene;
}

double error_m(const Scene& scene, const Transform& estimate) {
  double worst = 0;
  for (const auto& p : scene.source.points)
    worst = std::max(worst, displacement_m(scene.target_from_source, estimate, p.cast<double>()));
  return worst;
}

struct Tally {
  int right_trials = 0, right_runs = 0;
  double error_sum_m = 0, seconds = 0;
};

Tally tally(const char* bases, Sample sample, double excess_m) {
  constexpr int kTrials = 16;
  Tally sum;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const Scene scene = scene_of(sample, excess_m, seed);
    CongruentOptions options;
    options.bases = bases;
    options.max_trials = kTrials;
    options.stop_votes = 0, options.stop_score = 1;  // all trials are run: their shares are compared
    const std::clock_t start = std::clock();
    const CongruentResult result = register_congruent({scene.source.points, scene.source.normals, scene.at_boundary},
                                                      scene.target.view(), kTolerance, kOverlapGiven, seed, options);
    sum.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const auto right = std::ranges::find_if(result.transforms, [&](const ScoredTransform& t) {
      return error_m(scene, t.target_from_source) < 2 * kTolerance;
    });
    if (right == result.transforms.end()) continue;
    sum.right_trials += right->votes;
    if (right != result.transforms.begin()) continue;
    ++sum.right_runs;
    sum.error_sum_m += error_m(scene, right->target_from_source);
  }
  sum.right_trials = static_cast<int>(std::lround(100.0 * sum.right_trials / (kTrials * kRuns)));
  return sum;
}

}  // namespace

int main() {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  fmt::print(
      "| surface | overlap too long by | bases | trials that voted for the truth | right first | error of the right, m "
      "| CPU ms |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  const std::pair<const char*, Sample> surfaces[] = {
      {"yard", test::sample_yard}, {"hills", test::sample_hills}, {"balls", test::sample_balls}};
  for (const auto& [surface, sample] : surfaces)
    for (const double excess_m : {0.0, 0.3})
      for (const char* bases : {"area", "boundary"}) {
        const Tally t = tally(bases, sample, excess_m);
        fmt::print("| {} | {} m | {} | {} % | {}/{} | {:.3f} | {:.0f} |\n", surface, excess_m, bases, t.right_trials,
                   t.right_runs, kRuns, t.right_runs > 0 ? t.error_sum_m / t.right_runs : 0, 1000 * t.seconds / kRuns);
        std::fflush(stdout);
      }
}
