#include "evaluate/evaluate.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "evaluate/inputs.h"
#include "evaluate/overlap.h"
#include "evaluate/scan_points.h"

namespace isthmus::evaluate {
namespace {

constexpr double kRightDeg = 2.0;
constexpr double kRightVoxels = 2.0;
constexpr double kPlaceableOverlap = 0.1;
constexpr std::array<double, 4> kBandBounds{0.3, 0.2, 0.1, 0.05};
constexpr std::array<const char*, 5> kBandNames{">30%", "20-30%", "10-20%", "5-10%", "<5%"};

struct PoseError {
  double deg = 0;
  double m = 0;
};

/// Rotation error, and translation error at the point c of the source.
PoseError error_of(const Transform& estimate, const Transform& truth, const Eigen::Vector3d& c) {
  const Transform d = truth.inverse() * estimate;
  return {rotation_angle_rad(d.linear()) * 180.0 / std::numbers::pi, (d * c - c).norm()};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

template <class Get>
double median_of(const std::vector<PoseError>& errors, Get get) {
  std::vector<double> values;
  for (const PoseError& e : errors) values.push_back(get(e));
  return median(std::move(values));
}

int largest_part(const std::map<PairKey, double>& overlaps) {
  std::map<std::string, std::string> parent;
  const auto find = [&](std::string name) {
    parent.try_emplace(name, name);
    while (parent[name] != name) name = parent[name];
    return name;
  };
  for (const auto& [pair, overlap] : overlaps) {
    const std::string a = find(pair.first), b = find(pair.second);
    if (overlap > kPlaceableOverlap) parent[a] = b;
  }
  std::map<std::string, int> sizes;
  int largest = 0;
  for (const auto& [name, up] : parent) largest = std::max(largest, ++sizes[find(name)]);
  return largest;
}

struct Inputs {
  std::map<std::string, Transform> truth;
  std::vector<ScanRow> rows;
  std::vector<Edge> edges;
  Poses poses;  // names decoded
  Overlaps overlaps;
};

Result<void> judge_edges(const Inputs& in, const std::filesystem::path& scans_dir, Evaluation& out,
                         std::set<PairKey>& found) {
  std::map<int, std::string> name_of_id;
  for (const ScanRow& row : in.rows) name_of_id[row.id] = row.name;
  std::map<std::string, Eigen::Vector3d> centroids;
  out.edges = static_cast<int>(in.edges.size());
  for (const Edge& edge : in.edges) {
    const std::string target = name_of_id[edge.from], source = name_of_id[edge.to];
    const auto a = in.truth.find(target), b = in.truth.find(source);
    if (a == in.truth.end() || b == in.truth.end()) {
      out.wrong.push_back({target, source, std::nullopt, 0, std::nullopt});
      continue;
    }
    if (!centroids.contains(source)) {
      const Result<Points> points = load_points(scans_dir, source);
      if (!points) return tl::unexpected(points.error());
      centroids[source] = sampled_centroid(*points);
    }
    const PoseError e = error_of(edge.from_to, a->second.inverse() * b->second, centroids[source]);
    const PairKey key = pair_key(target, source);
    if (e.deg < kRightDeg && e.m < kRightVoxels * out.voxel_m) {
      ++out.right;
      found.insert(key);
      continue;
    }
    const auto overlap = in.overlaps.of.find(key);
    out.wrong.push_back({target, source, e.deg, e.m,
                         overlap == in.overlaps.of.end() ? std::nullopt : std::optional<double>(overlap->second)});
  }
  return {};
}

std::vector<Band> bands_of(const Overlaps& overlaps, const std::set<PairKey>& found) {
  std::array<Band, kBandNames.size()> bands;
  for (std::size_t k = 0; k < bands.size(); ++k) bands[k].name = kBandNames[k];
  for (const auto& [pair, overlap] : overlaps.of) {
    std::size_t k = 0;
    while (k < kBandBounds.size() && overlap <= kBandBounds[k]) ++k;
    ++bands[k].pairs;
    bands[k].found += found.contains(pair);
  }
  std::vector<Band> out;
  for (Band& band : bands)
    if (band.pairs > 0) out.push_back(std::move(band));
  return out;
}

/// Errors of one component in the gauge of the scan that gives the smallest median translation error.
std::vector<PoseError> best_gauge(const std::vector<std::pair<Transform, Transform>>& estimate_and_truth) {
  std::vector<PoseError> best;
  double best_median = 0;
  for (const auto& [anchor_estimate, anchor_truth] : estimate_and_truth) {
    const Transform common_from_component = anchor_truth * anchor_estimate.inverse();
    std::vector<PoseError> errors;
    for (const auto& [estimate, truth] : estimate_and_truth)
      errors.push_back(
          error_of(truth.inverse() * common_from_component * estimate, Transform::Identity(), Eigen::Vector3d::Zero()));
    const double m = median_of(errors, [](const PoseError& e) { return e.m; });
    if (best.empty() || m < best_median) best = std::move(errors), best_median = m;
  }
  return best;
}

void judge_poses(const Inputs& in, const EvaluateOptions& options, Evaluation& out) {
  std::map<std::string, std::string> component_of;
  for (const ScanRow& row : in.rows) component_of[row.name] = row.component;
  std::map<std::string, std::vector<std::pair<Transform, Transform>>> members;
  for (const auto& [name, pose] : in.poses) {
    const auto truth = in.truth.find(name);
    if (truth == in.truth.end())
      out.unknown_placed.push_back(name);
    else if (component_of.contains(name))
      members[component_of[name]].emplace_back(pose, truth->second);
  }
  PoseScore score;
  std::vector<PoseError> all;
  for (const auto& [component, scans] : members) {
    if (scans.size() < 2) continue;
    const std::vector<PoseError> errors = best_gauge(scans);
    all.insert(all.end(), errors.begin(), errors.end());
    score.components.push_back(static_cast<int>(errors.size()));
  }
  if (all.empty()) return;
  const double max_m = options.max_m.value_or(kRightVoxels * out.voxel_m);
  score.placed = static_cast<int>(all.size());
  score.of = static_cast<int>(in.truth.size());
  for (const PoseError& e : all) {
    score.within += e.deg < options.max_deg && e.m < max_m;
    score.max_deg = std::max(score.max_deg, e.deg);
    score.max_m = std::max(score.max_m, e.m);
  }
  score.median_deg = median_of(all, [](const PoseError& e) { return e.deg; });
  score.median_m = median_of(all, [](const PoseError& e) { return e.m; });
  out.poses = score;
}

Result<Overlaps> overlaps_for(const Inputs& in, const std::filesystem::path& scans_dir,
                              const EvaluateOptions& options) {
  if (options.overlaps) {
    Result<Overlaps> read = read_overlaps(*options.overlaps);
    if (read && options.voxel_m) read->voxel_m = options.voxel_m;
    if (read && !read->voxel_m)
      return fail("has no line '# voxel V'", options.overlaps->string(), "give the evaluation voxel");
    return read;
  }
  std::optional<double> voxel = options.voxel_m;
  for (const ScanRow& row : in.rows)
    if (!options.voxel_m && row.voxel_m && *row.voxel_m > voxel.value_or(0)) voxel = row.voxel_m;
  if (!voxel || *voxel <= 0)
    return fail("the evaluation voxel is not known", scans_dir.string(), "give an overlap file or a voxel");
  return compute_overlaps(scans_dir, {in.truth.begin(), in.truth.end()}, *voxel);
}

template <class T>
Result<void> take(Result<T> from, T& into) {
  if (!from) return tl::unexpected(from.error());
  into = std::move(*from);
  return {};
}

}  // namespace

std::optional<std::filesystem::path> truth_beside(const std::filesystem::path& scans_dir) {
  std::error_code code;
  for (const char* name : {"poses.gt.txt", "poses_refined.txt", "poses.txt"})
    if (std::filesystem::exists(scans_dir / name, code)) return scans_dir / name;
  return std::nullopt;
}

Result<Evaluation> evaluate(const std::filesystem::path& out_dir, const std::filesystem::path& scans_dir,
                            const EvaluateOptions& options) {
  Inputs in;
  Poses truth;
  if (auto r = take(read_poses(options.truth), truth); !r) return tl::unexpected(r.error());
  if (truth.empty()) return fail("holds no pose", options.truth.string(), "expected lines of a name and 12 numbers");
  in.truth.insert(truth.begin(), truth.end());
  if (auto r = take(read_scans_csv(out_dir / "scans.csv"), in.rows); !r) return tl::unexpected(r.error());
  if (auto r = take(read_g2o_edges(out_dir / "pose_graph.g2o"), in.edges); !r) return tl::unexpected(r.error());
  if (auto r = take(read_poses(out_dir / "poses.txt"), in.poses); !r) return tl::unexpected(r.error());
  for (auto& [name, pose] : in.poses) name = file_name_of(name);
  if (auto r = take(overlaps_for(in, scans_dir, options), in.overlaps); !r) return tl::unexpected(r.error());

  Evaluation out;
  out.voxel_m = *in.overlaps.voxel_m;
  out.placeable = largest_part(in.overlaps.of);
  std::set<PairKey> found;
  if (auto r = judge_edges(in, scans_dir, out, found); !r) return tl::unexpected(r.error());
  out.bands = bands_of(in.overlaps, found);
  judge_poses(in, options, out);
  return out;
}

}  // namespace isthmus::evaluate
