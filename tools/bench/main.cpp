// isthmus_bench: every pair of sets with ground truth, turned at random, with and without each stage.
#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <filesystem>
#include <thread>

#include "base/atomic_file.h"
#include "bench/pair_trial.h"
#include "bench/whole_clouds.h"

namespace {

using namespace isthmus;
using namespace isthmus::bench;
namespace fs = std::filesystem;

struct Variant {
  std::string name;
  std::vector<std::string> assignments;
  bool whole_clouds = false;  ///< the baseline instead of the method
};

struct BenchRun {
  std::vector<std::string> sets;
  std::vector<std::string> variants;
  std::vector<std::string> assignments;
  std::string work = "bench";
  std::string csv;
  std::uint64_t seed = 1;
  double voxel_m = 0;
  double min_overlap = 0;
  int threads = static_cast<int>(std::thread::hardware_concurrency());
  bool ablation = false;
  bool whole_clouds = false;
  WholeClouds baseline;
  Degradation degradation;
};

// Each stage left out in turn, and plain Super4PCS on the whole clouds' overlap with nothing before it.
std::vector<Variant> ablation_variants() {
  std::vector<Variant> out;
  for (const char* part : {"growth", "super4pcs", "fine", "rarity", "free_space", "upright", "observed"})
    out.push_back({fmt::format("without {}", part), {fmt::format("pair.without=[{}]", part)}, false});
  out.push_back({"without stem votes", {"pair.generators=[axis_votes, column_votes, pair_votes]"}, false});
  out.push_back({"without stem and column votes", {"pair.generators=[axis_votes, pair_votes]"}, false});
  out.push_back({"axis votes only", {"pair.generators=[axis_votes]"}, false});
  out.push_back({"pair votes only", {"pair.generators=[pair_votes]"}, false});
  return out;
}

// "name:key=value;key=value"
Variant variant_from(const std::string& text) {
  const std::size_t colon = text.find(':');
  Variant variant{text.substr(0, colon), {}, false};
  std::size_t at = colon;
  while (at != std::string::npos && at + 1 < text.size()) {
    const std::size_t end = text.find(';', at + 1);
    variant.assignments.push_back(text.substr(at + 1, end == std::string::npos ? end : end - at - 1));
    at = end;
  }
  return variant;
}

// Pairs side by side, each on one thread, so that seconds are those of one core.
template <class RunPair>
std::vector<PairTrial> trials_of(const BenchSet& set, const RunPair& run_pair, double min_overlap, int threads) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [pair, overlap] : set.overlap)
    if (overlap >= min_overlap) pairs.push_back(pair);
  std::vector<PairTrial> trials(pairs.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> workers;
  for (int k = 0; k < threads; ++k)
    workers.emplace_back([&] {
      oneapi::tbb::task_arena arena(1);
      arena.execute([&] {
        for (std::size_t i = next++; i < pairs.size(); i = next++)
          trials[i] = run_pair(set, pairs[i].second, pairs[i].first);
      });
    });
  workers.clear();
  return trials;
}

Result<void> run(const BenchRun& bench) {
  std::vector<Variant> variants{{"default", {}, false}};
  if (bench.whole_clouds) variants.push_back({"super4pcs on whole clouds", {}, true});
  if (bench.ablation)
    for (Variant& v : ablation_variants()) variants.push_back(std::move(v));
  for (const std::string& text : bench.variants) variants.push_back(variant_from(text));
  std::vector<fs::path> folders;
  for (const std::string& text : bench.sets) {
    const auto place = set_place_from(text);
    if (!place) return tl::unexpected(place.error());
    const std::string parent = fs::absolute(place->folder).lexically_normal().filename().string();
    const std::string kind = text.rfind(':') == std::string::npos ? "full" : text.substr(text.rfind(':') + 1);
    folders.push_back(fs::path(bench.work) /
                      fmt::format("{}-{}-{}{}", parent, kind, bench.seed, suffix_of(bench.degradation)));
    const auto voxel = bench.voxel_m > 0 ? std::optional(bench.voxel_m) : std::nullopt;
    if (const auto done = scramble_set(*place, bench.seed, voxel, bench.degradation, folders.back()); !done)
      return done;
  }
  for (const Variant& variant : variants) {
    pipelines::Settings settings;
    std::vector<std::string> all = bench.assignments;
    all.insert(all.end(), variant.assignments.begin(), variant.assignments.end());
    if (const auto done = pipelines::apply_assignments(settings, all); !done) return done;
    std::vector<PairTrial> trials;
    for (const fs::path& folder : folders) {
      const auto set = load_set(folder, settings);
      if (!set) return tl::unexpected(set.error());
      const auto run_pair = [&](const BenchSet& of, std::size_t source, std::size_t target) {
        return variant.whole_clouds ? run_whole_clouds(of, source, target, bench.baseline)
                                    : run_trial(of, source, target, settings.pair);
      };
      const auto more = trials_of(*set, run_pair, bench.min_overlap, bench.threads);
      fmt::print(stderr, "{}: {}: {} pairs\n", variant.name, set->name, more.size());
      trials.insert(trials.end(), more.begin(), more.end());
    }
    fmt::print("\n**{}**\n\n{}", variant.name, table_of(trials));
    std::fflush(stdout);
    if (!bench.csv.empty()) {
      fs::create_directories(bench.csv);
      const auto written = write_file_atomically(fs::path(bench.csv) / (variant.name + ".csv"), csv_of(trials));
      if (!written) return written;
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Every pair of sets with ground truth, turned at random, with and without each stage.", "isthmus_bench");
  BenchRun bench;
  app.add_option("SETS", bench.sets, "Folders of scans with truth: DIR or DIR:none|yaw|full|object (default full)")
      ->required();
  app.add_option("--work", bench.work, "Folder for the turned copies and their products")->capture_default_str();
  app.add_option("--csv", bench.csv, "Folder for one table a variant, a row a pair");
  app.add_option("--seed", bench.seed, "Seed of the random turns")->capture_default_str();
  app.add_option("--voxel", bench.voxel_m, "Evaluation voxel of sets without overlaps.gt.txt, metres");
  app.add_option("--min-overlap", bench.min_overlap, "Pairs below it are left out")->capture_default_str();
  app.add_option("--threads", bench.threads, "Pairs side by side, each on one thread")->capture_default_str();
  app.add_option("--set", bench.assignments, "A setting for all variants, such as sampling.voxel_m=0.1")
      ->allow_extra_args(false);
  app.add_option("--variant", bench.variants, "NAME:key=value;key=value: one more variant beside the default")
      ->allow_extra_args(false);
  app.add_option("--noise", bench.degradation.noise_voxels,
                 "Normal error on every coordinate, standard deviation in evaluation voxels")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--outliers", bench.degradation.outliers,
                 "Share of the points that are spread evenly over the scan's bounding box")
      ->check(CLI::Range(0.0, 0.95));
  app.add_option("--density", bench.degradation.density,
                 "Share of its points that every second scan keeps; only pairs of unlike densities are run")
      ->check(CLI::Range(0.001, 1.0));
  app.add_flag("--whole-clouds", bench.whole_clouds, "Also Super4PCS on the whole sampled clouds, for comparison");
  app.add_option("--whole-overlap", bench.baseline.overlap, "Overlap that it assumes")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  app.add_option("--whole-trials", bench.baseline.max_trials, "Bases that it tries at most")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--ablation", bench.ablation, "Also each stage left out in turn");
  CLI11_PARSE(app, argc, argv);
  if (const auto done = run(bench); !done) {
    fmt::print(stderr, "isthmus_bench: {}\n", done.error().text());
    return 1;
  }
  return 0;
}
