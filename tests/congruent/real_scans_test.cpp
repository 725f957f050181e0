// Whole real scans, turned at random, without knowing their overlap: the baseline that regions must beat.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "congruent/register.h"
#include "congruent/synthetic.h"
#include "io/scan_reader.h"
#include "scan/sampling.h"

namespace isthmus::congruent {
namespace {

namespace fs = std::filesystem;

fs::path shared_folder() {
  if (const char* set = std::getenv("ISTHMUS_SHARED")) return set;
  return fs::path(ISTHMUS_SOURCE_DIR).parent_path() / "shared";
}

struct Scan {
  test::Cloud cloud;
  Transform common_from_scan = Transform::Identity();
};

test::Cloud load(const fs::path& path, double voxel_m) {
  const auto refs = io::scans_of_file(path);
  if (!refs) return {};
  const auto reader = io::open_scan(refs->front());
  if (!reader) return {};
  VoxelSampler sampler((*reader)->header(), voxel_m, {});
  PointChunk chunk;
  while ((*reader)->read(chunk, 100000) && !chunk.points.empty()) sampler.add(chunk);
  const auto sampled = sampler.finish();
  if (!sampled) return {};
  Transform scan_from_local = Transform::Identity();
  scan_from_local.translation() = sampled->local_origin_in_scan;
  return test::moved({sampled->points, sampled->normals}, scan_from_local);
}

// Lines of "name r00 r01 r02 tx ..." as in the survey's poses.txt, each scan turned by a rotation drawn from its name.
std::map<std::string, Scan> load_turned(const fs::path& folder, double voxel_m) {
  std::map<std::string, Scan> scans;
  std::ifstream file(folder / "poses.txt");
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name;
    words >> name;
    Transform common_from_file = Transform::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) words >> common_from_file.matrix()(r, c);
    Rng rng(seed_of(1, name));
    const Transform turned_from_file = test::random_transform(rng, 10);
    scans[name] = {test::moved(load(folder / name, voxel_m), turned_from_file),
                   common_from_file * turned_from_file.inverse()};
  }
  return scans;
}

bool is_right(const Transform& estimate, const Scan& source, const Scan& target, double voxel_m) {
  const Transform truth = target.common_from_scan.inverse() * source.common_from_scan;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : source.cloud.points) mean += p.cast<double>() / static_cast<double>(source.cloud.points.size());
  return displacement_m(estimate, truth, mean) < 2 * voxel_m &&
         rotation_angle_rad(estimate.linear().transpose() * truth.linear()) < 0.05;
}

struct Survey {
  const char* folder;
  double voxel_m;
  double least_overlap;  // pairs below are not tried
  double share_right;    // that must come out first
};
void PrintTo(const Survey& s, std::ostream* out) { *out << s.folder; }

class WholeScans : public testing::TestWithParam<Survey> {};

TEST_P(WholeScans, AreRegisteredThoughTheirOverlapIsNotKnown) {
  constexpr double kAssumedOverlap = 0.4;
  const Survey& survey = GetParam();
  const fs::path folder = shared_folder() / "data" / survey.folder;
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there; set ISTHMUS_SHARED";
  const auto scans = load_turned(folder, survey.voxel_m);
  int tried = 0, right = 0;
  std::string wrong;
  std::ifstream file(folder / "overlaps.gt.txt");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string a, b;
    double overlap = 0;
    if (line[0] == '#' || !(words >> a >> b >> overlap) || overlap < survey.least_overlap) continue;
    const Scan &source = scans.at(a), &target = scans.at(b);
    const auto result = register_congruent(source.cloud.view(), target.cloud.view(), 1.5 * survey.voxel_m,
                                           kAssumedOverlap, seed_of(1, a + b), {});
    ++tried;
    const bool first = !result.transforms.empty() &&
                       is_right(result.transforms.front().target_from_source, source, target, survey.voxel_m);
    right += first ? 1 : 0;
    if (!first) wrong += fmt::format(" {}-{} ({:.2f})", a, b, overlap);
  }
  ASSERT_GT(tried, 2);
  EXPECT_GE(right, survey.share_right * tried) << "of " << tried << " pairs these are not right:" << wrong;
  RecordProperty("right", right);
  RecordProperty("tried", tried);
}
INSTANTIATE_TEST_SUITE_P(Real, WholeScans,
                         testing::Values(Survey{"tls_eth_facade", 0.5, 0.3, 0.9},
                                         Survey{"newer_college_01", 0.5, 0.3, 1.0},
                                         Survey{"fragments_redkitchen", 0.1, 0.4, 1.0}),
                         [](const auto& instance) { return std::string(instance.param.folder); });

}  // namespace
}  // namespace isthmus::congruent
