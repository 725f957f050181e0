// A set of four stations in one hall, through the bench: copies, both methods, tables.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "bench/whole_clouds.h"
#include "io/scan_writer.h"
#include "pairwise/synthetic_scene.h"

namespace isthmus::bench {
namespace {

namespace fs = std::filesystem;
using isthmus::testing::furnished_hall;
using isthmus::testing::pose_of;
using isthmus::testing::scan_scene;

constexpr double kVoxel = 0.2;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("isthmus_bench_" + name);
  fs::remove_all(folder);
  return folder;
}

// Scans a, b, c, d with truth; the stated overlaps only sort the pairs into bands.
fs::path hall_set(const std::string& name) {
  const fs::path folder = fresh_folder(name);
  fs::create_directories(folder);
  std::ofstream poses(folder / "poses.gt.txt"), overlaps(folder / "overlaps.gt.txt");
  overlaps << "# voxel " << kVoxel << "\n";
  std::vector<std::string> names;
  for (int k = 0; k < 4; ++k) {
    const Transform pose = pose_of({-3.0 + 2 * k, 0.3 * k, 1.7}, {0, 0, 0.9 * k});
    PointChunk chunk;
    chunk.points = scan_scene(furnished_hall(1), pose, {40000, 1e6, 0.003, static_cast<std::uint64_t>(k + 1)});
    const std::string file = fmt::format("{}.ply", static_cast<char>('a' + k));
    EXPECT_TRUE(io::write_scan(folder / file, chunk));
    poses << file;
    for (int i = 0; i < 12; ++i) poses << ' ' << pose(i / 4, i % 4);
    poses << '\n';
    for (const auto& other : names) overlaps << other << ' ' << file << " 0.6\n";
    names.push_back(file);
  }
  return folder;
}

TEST(BenchSets, TheSameSeedGivesTheSameFilesAndAnotherOthers) {
  const SetPlace set{hall_set("seeds"), Scramble::full};
  const Degradation worse{.noise_voxels = 0.5, .outliers = 0.1, .density = 0.5};
  const fs::path one = fresh_folder("one"), two = fresh_folder("two"), other = fresh_folder("other");
  ASSERT_TRUE(scramble_set(set, 1, {}, worse, one));
  ASSERT_TRUE(scramble_set(set, 1, {}, worse, two));
  ASSERT_TRUE(scramble_set(set, 2, {}, worse, other));
  for (const char* name : {"a.ply", "b.ply", "poses.gt.txt", "overlaps.gt.txt"}) {
    EXPECT_EQ(text_of(one / name), text_of(two / name)) << name;
  }
  for (const char* name : {"a.ply", "b.ply", "poses.gt.txt"}) {
    EXPECT_NE(text_of(one / name), text_of(other / name)) << name;
  }
}

TEST(BenchSets, UnlikeDensitiesLeaveThePairsOfAThinnedAndAWholeScan) {
  const SetPlace set{hall_set("density"), Scramble::full};
  const fs::path whole = fresh_folder("whole"), thin = fresh_folder("thin");
  ASSERT_TRUE(scramble_set(set, 1, {}, {}, whole));
  ASSERT_TRUE(scramble_set(set, 1, {}, {.density = 0.1}, thin));
  EXPECT_EQ(fs::file_size(whole / "a.ply"), fs::file_size(thin / "a.ply"));
  const auto share =
      static_cast<double>(fs::file_size(thin / "b.ply")) / static_cast<double>(fs::file_size(whole / "b.ply"));
  EXPECT_NEAR(share, 0.1, 0.01);
  const auto pairs = evaluate::read_overlaps(thin / "overlaps.gt.txt");
  ASSERT_TRUE(pairs);
  EXPECT_EQ(pairs->of.size(), 4u);
  EXPECT_TRUE(pairs->of.contains({"a.ply", "b.ply"}));
  EXPECT_FALSE(pairs->of.contains({"a.ply", "c.ply"}));
  EXPECT_EQ(text_of(whole / "poses.gt.txt"), text_of(thin / "poses.gt.txt")) << "the truth is the same";
}

TEST(BenchSets, NoiseWithoutAnEvaluationVoxelIsRefused) {
  const fs::path folder = hall_set("no_voxel");
  std::ofstream(folder / "overlaps.gt.txt") << "a.ply b.ply 0.6\n";
  const auto done = scramble_set({folder, Scramble::full}, 1, {}, {.noise_voxels = 1}, fresh_folder("no_voxel_to"));
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find("--voxel"), std::string::npos) << done.error().text();
}

TEST(BenchPairs, BothMethodsFindAnEasyPairAndAreMeasuredAlike) {
  const fs::path to = fresh_folder("easy");
  ASSERT_TRUE(scramble_set({hall_set("easy_set"), Scramble::yaw}, 1, {}, {}, to));
  pipelines::Settings settings;
  settings.sampling.voxel_m = kVoxel;
  const auto set = load_set(to, settings);
  ASSERT_TRUE(set);
  ASSERT_EQ(set->overlap.size(), 6u);
  const PairTrial method = run_trial(*set, 1, 0, settings.pair);
  const PairTrial baseline = run_whole_clouds(*set, 1, 0, {});
  for (const PairTrial* t : {&method, &baseline}) {
    EXPECT_TRUE(t->right) << t->rotation_deg << " deg, " << t->translation_m << " m";
    EXPECT_LT(t->translation_m, kVoxel);
    EXPECT_GT(t->cpu_s, 0);
    EXPECT_GT(t->rank.back(), 0);
    EXPECT_EQ(t->overlap, 0.6);
    EXPECT_EQ(t->source, "b.ply");
  }
  EXPECT_EQ(method.result.verdict, Verdict::accepted) << method.result.reason;
  EXPECT_NE(baseline.result.verdict, Verdict::accepted) << "the baseline has no verdict";
  const PairTrial again = run_whole_clouds(*set, 1, 0, {});
  EXPECT_EQ(again.result.target_from_source->matrix(), baseline.result.target_from_source->matrix());
  EXPECT_FALSE(run_whole_clouds(*set, 1, 0, {.overlap = 0.35, .max_trials = 0}).right);
}

PairTrial made_trial(double overlap, bool right, Verdict verdict, double cpu_s) {
  PairTrial t;
  t.overlap = overlap, t.right = right, t.cpu_s = cpu_s;
  t.result.verdict = verdict;
  return t;
}

TEST(BenchTables, BandsCountRightAndAcceptedPairsAndProcessorTime) {
  std::vector<PairTrial> trials;
  for (int k = 0; k < 20; ++k) trials.push_back(made_trial(0.5, k < 15, Verdict::ambiguous, 0.1 * (k + 1)));
  trials.push_back(made_trial(0.01, false, Verdict::accepted, 9));
  const std::string table = table_of(trials);
  EXPECT_NE(table.find("| above 30 % | 20 | 15 (75 %) | 0 | 0 |"), std::string::npos) << table;
  EXPECT_NE(table.find("| 1.10 | 2.00 | 2.00 |\n"), std::string::npos) << table;
  EXPECT_NE(table.find("| below 5 % | 1 | 0 (0 %) | 1 | 1 |"), std::string::npos) << table;
  EXPECT_NE(table.find("| all | 21 | 15 (71 %) | 1 | 1 |"), std::string::npos) << table;
  EXPECT_EQ(table.find("10-20"), std::string::npos) << "bands without pairs are left out";
}

TEST(BenchTables, EveryRowOfTheCsvHasAsManyColumnsAsItsHeader) {
  std::vector<PairTrial> trials{made_trial(0.5, true, Verdict::accepted, 1),
                                made_trial(0.1, false, Verdict::failed, 2)};
  trials[0].result.evidence = {{"score", 0.4}};
  trials[1].result.seconds_by_stage = {{"growth", 0.1}, {"growth", 0.2}};
  const auto rows = evaluate::parse_csv(csv_of(trials));
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  const auto column = std::find(rows[0].begin(), rows[0].end(), "s_growth") - rows[0].begin();
  EXPECT_EQ(rows[2][static_cast<std::size_t>(column)], "0.3");
}

}  // namespace
}  // namespace isthmus::bench
