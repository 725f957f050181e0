#include "bench/bench_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "evaluate/evaluate.h"
#include "evaluate/overlap.h"
#include "evaluate/scan_points.h"
#include "io/scan_writer.h"
#include "pipelines/planning.h"
#include "store/store.h"

namespace isthmus::bench {
namespace {

namespace fs = std::filesystem;

// Uniform in SO(3) (Shoemake 1992).
Eigen::Quaterniond random_rotation(Rng& rng) {
  const double u = rng.uniform(), a = 2 * std::numbers::pi * rng.uniform(), b = 2 * std::numbers::pi * rng.uniform();
  return {std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b),
          std::sqrt(u) * std::cos(b)};
}

Transform random_motion(Scramble kind, double extent_m, Rng& rng) {
  Transform t = Transform::Identity();
  if (kind == Scramble::none) return t;
  if (kind == Scramble::yaw) {
    t.linear() = Eigen::AngleAxisd(rng.uniform(-std::numbers::pi, std::numbers::pi), Eigen::Vector3d::UnitZ())
                     .toRotationMatrix();
    return t;
  }
  t.linear() = random_rotation(rng).toRotationMatrix();
  if (kind == Scramble::object)
    for (int a = 0; a < 3; ++a) t.translation()[a] = rng.uniform(-extent_m, extent_m);
  return t;
}

double longest_side(const evaluate::Points& points) {
  Eigen::AlignedBox3d box;
  for (const auto& p : points) box.extend(p);
  return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
}

std::string pose_line(const std::string& name, const Transform& t) {
  std::string line = name;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) line += fmt::format(" {:.12g}", t(r, c));
  return line + "\n";
}

std::string ply_name(const std::string& name) { return fs::path(name).stem().string() + ".ply"; }

Result<evaluate::Overlaps> overlaps_of(const fs::path& folder, const evaluate::Poses& truth,
                                       std::optional<double> voxel_m) {
  if (fs::exists(folder / "overlaps.gt.txt")) return evaluate::read_overlaps(folder / "overlaps.gt.txt");
  if (!voxel_m) return fail("no overlaps.gt.txt", folder.string(), "give the evaluation voxel with --voxel");
  return evaluate::compute_overlaps(folder, truth, *voxel_m);
}

}  // namespace

std::optional<Scramble> scramble_from(const std::string& word) {
  if (word == "none") return Scramble::none;
  if (word == "yaw") return Scramble::yaw;
  if (word == "full") return Scramble::full;
  if (word == "object") return Scramble::object;
  return std::nullopt;
}

Result<SetPlace> set_place_from(const std::string& text) {
  SetPlace place;
  const std::size_t colon = text.rfind(':');
  place.folder = text.substr(0, colon);
  if (colon != std::string::npos) {
    const auto kind = scramble_from(text.substr(colon + 1));
    if (!kind)
      return fail(fmt::format("unknown kind of turning '{}'", text.substr(colon + 1)), text,
                  "none, yaw, full or object");
    place.scramble = *kind;
  }
  if (!fs::is_directory(place.folder)) return fail("no such folder", place.folder.string());
  return place;
}

Result<void> scramble_set(const SetPlace& set, std::uint64_t seed, std::optional<double> voxel_m,
                          const Degradation& degradation, const fs::path& to) {
  if (fs::exists(to / "poses.gt.txt")) return {};
  const auto truth_file = evaluate::truth_beside(set.folder);
  if (!truth_file) return fail("no ground truth (poses.gt.txt, poses_refined.txt or poses.txt)", set.folder.string());
  const auto truth = evaluate::read_poses(*truth_file);
  if (!truth) return tl::unexpected(truth.error());
  const auto overlaps = overlaps_of(set.folder, *truth, voxel_m);
  if (!overlaps) return tl::unexpected(overlaps.error());
  const std::optional<double> evaluation_voxel = overlaps->voxel_m ? overlaps->voxel_m : voxel_m;
  if (degradation.noise_voxels > 0 && !evaluation_voxel)
    return fail("noise is counted in evaluation voxels and overlaps.gt.txt names none", set.folder.string(),
                "give it with --voxel");
  fs::create_directories(to);
  std::string poses;
  std::set<std::string> thinned;
  for (std::size_t k = 0; k < truth->size(); ++k) {
    const auto& [name, common_from_scan] = (*truth)[k];
    if (degradation.density < 1 && k % 2 == 1) thinned.insert(name);
    const auto loaded = evaluate::load_points(set.folder, name);
    if (!loaded) return tl::unexpected(loaded.error());
    const evaluate::Points worse = degraded(*loaded, degradation, thinned.contains(name), evaluation_voxel.value_or(0),
                                            Rng(seed_of(seed_of(seed, "degraded"), name)));
    Rng rng(seed_of(seed, name));
    const Transform turned_from_scan = random_motion(set.scramble, longest_side(*loaded), rng);
    PointChunk chunk;
    for (const auto& p : worse) chunk.points.push_back((turned_from_scan * p).cast<float>());
    if (const auto written = io::write_scan(to / ply_name(name), chunk); !written) return written;
    poses += pose_line(ply_name(name), common_from_scan * turned_from_scan.inverse());
  }
  std::string table = fmt::format("# voxel {:g}\n", evaluation_voxel.value_or(0));
  for (const auto& [pair, overlap] : overlaps->of)
    if (degradation.density == 1 || thinned.contains(pair.first) != thinned.contains(pair.second))
      table += fmt::format("{} {} {:.4f}\n", ply_name(pair.first), ply_name(pair.second), overlap);
  if (const auto written = write_file_atomically(to / "overlaps.gt.txt", table); !written) return written;
  return write_file_atomically(to / "poses.gt.txt", poses);
}

Result<BenchSet> load_set(const fs::path& folder, const pipelines::Settings& settings) {
  BenchSet set;
  set.name = folder.filename().string();
  const auto truth = evaluate::read_poses(folder / "poses.gt.txt");
  if (!truth) return tl::unexpected(truth.error());
  const auto overlaps = evaluate::read_overlaps(folder / "overlaps.gt.txt");
  if (!overlaps) return tl::unexpected(overlaps.error());
  set.evaluation_voxel_m = overlaps->voxel_m.value_or(0);
  const auto listing = io::list_scans({folder});
  if (!listing) return tl::unexpected(listing.error());
  const auto store = store::Store::open(folder / "store", {});
  if (!store) return tl::unexpected(store.error());
  const std::atomic<bool> never{false};
  const auto plan = pipelines::plan_survey(listing->scans, settings, *store, {}, never);
  if (!plan.failed.empty()) return tl::unexpected(plan.failed.front().error);
  const std::map<std::string, Transform> pose_of(truth->begin(), truth->end());
  set.scans.resize(plan.scans.size());
  std::vector<std::optional<Error>> errors(plan.scans.size());
  const pipelines::ProductMaker maker(settings, *store);
  parallel_for_index(plan.scans.size(), 1, [&](std::size_t k) {
    BenchScan& scan = set.scans[k];
    scan.name = plan.scans[k].ref.name;
    std::vector<pipelines::StageTime> times;
    auto product = maker.product(plan.scans[k], times);
    const auto points = evaluate::load_points(folder, scan.name);
    if (!product)
      errors[k] = product.error();
    else if (!points)
      errors[k] = points.error();
    else if (!pose_of.contains(scan.name))
      errors[k] = Error{"is not in the truth", scan.name, {}};
    else
      scan.product = std::move(*product), scan.centroid = evaluate::sampled_centroid(*points),
      scan.common_from_scan = pose_of.at(scan.name);
  });
  for (const auto& error : errors)
    if (error) return tl::unexpected(*error);
  for (std::size_t a = 0; a < set.scans.size(); ++a)
    for (std::size_t b = a + 1; b < set.scans.size(); ++b) {
      const auto found = overlaps->of.find(evaluate::pair_key(set.scans[a].name, set.scans[b].name));
      if (found != overlaps->of.end()) set.overlap[{a, b}] = found->second;
    }
  return set;
}

}  // namespace isthmus::bench
