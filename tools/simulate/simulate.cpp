#include "simulate/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/atomic_file.h"
#include "base/rng.h"
#include "io/scan_writer.h"
#include "simulate/movers.h"
#include "simulate/scanner.h"
#include "simulate/scene.h"
#include "simulate/stations.h"

namespace isthmus {
namespace {

using sim::RayScene;
using sim::Scene;
using sim::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// A place, ready to be scanned.
struct Place {
  Scene scene;  ///< its mesh has moved into `solids`
  RayScene solids;
  std::vector<Vector3d> stations;
};

Result<Place> make_place(const std::string& kind, const sim::SceneRequest& request) {
  Scene scene = sim::build_scene(kind, request);
  Result<RayScene> solids = RayScene::build(std::move(scene.mesh));
  if (!solids) return tl::unexpected(solids.error());
  Result<std::vector<Vector3d>> stations = sim::settle_stations(*solids, scene.stations);
  if (!stations) return tl::unexpected(stations.error());
  return Place{std::move(scene), std::move(*solids), std::move(*stations)};
}

sim::ScannerModel model_of(const SimulateOptions& o) {
  sim::ScannerModel m;
  m.step_rad = o.resolution_deg * kRadPerDeg;
  m.min_range_m = o.min_range_m;
  m.max_range_m = o.max_range_m;
  m.noise_m = o.noise_m;
  m.noise_per_m = o.noise_ppm * 1e-6;
  m.beam_rad = o.beam_mrad * 1e-3;
  m.dropouts = o.dropouts;
  m.signal_loss = o.signal_loss;
  m.glass = o.glass;
  m.keep_no_return = o.keep_no_return;
  return m;
}

/// Uniform over all rotations (Shoemake 1992).
Eigen::Matrix3d random_rotation(Rng& rng) {
  const double u = rng.uniform(), a = 2 * std::numbers::pi * rng.uniform(), b = 2 * std::numbers::pi * rng.uniform();
  return Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a),
                            std::sqrt(u) * std::sin(b))
      .toRotationMatrix();
}

sim::Station set_up(const Vector3d& centre, const SimulateOptions& o, std::uint64_t seed) {
  Rng rng(seed_of(seed, "set-up"));
  const double heading = rng.uniform(0, 2 * std::numbers::pi);
  const double tilt_x = o.tilt_deg * kRadPerDeg * rng.normal(), tilt_y = o.tilt_deg * kRadPerDeg * rng.normal();
  const Eigen::Matrix3d turn = random_rotation(rng);
  sim::Station station;
  station.common_from_instrument = sim::upright(centre, o.orientation == "none" ? 0.0 : heading);
  station.common_from_instrument.linear() =
      rotation_from_vector({tilt_x, tilt_y, 0}) * station.common_from_instrument.linear();
  if (o.orientation == "full") station.scan_from_instrument.linear() = turn;
  station.seed = seed_of(seed, "rays");
  return station;
}

io::PointChunk scan_place(const Place& place, const sim::Station& station, const SimulateOptions& o, std::uint64_t seed,
                          Result<void>& status) {
  sim::Mesh moving;
  if (o.movers) {
    Rng rng(seed_of(seed, "movers"));
    moving = sim::movers_around(station.common_from_instrument.translation(), place.scene, place.solids, rng);
  }
  const bool something_moves = !moving.triangles.empty();
  const Result<RayScene> moved = RayScene::build(std::move(moving));
  if (!moved) {
    status = tl::unexpected(moved.error());
    return {};
  }
  return sim::scan_from(station, {&place.solids, something_moves ? &*moved : nullptr}, model_of(o));
}

std::string pose_line(const std::string& name, const sim::Station& station) {
  const Transform pose = station.common_from_instrument * station.scan_from_instrument.inverse();
  std::string line = name;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) line += fmt::format(" {:.15g}", pose.linear()(r, c));
    line += fmt::format(" {:.15g}", pose.translation()(r));
  }
  return line + "\n";
}

/// Which of the numbered scans are foreign: `foreign` of them, scattered by the seed.
std::vector<bool> scatter_foreign(int stations, int foreign, std::uint64_t seed) {
  std::vector<bool> is_foreign(static_cast<std::size_t>(stations), false);
  is_foreign.resize(static_cast<std::size_t>(stations + foreign), true);
  Rng rng(seed_of(seed, "foreign places"));
  for (std::size_t k = is_foreign.size(); k > 1; --k) {
    const auto other = static_cast<std::size_t>(rng.below(k));
    const bool last = is_foreign[k - 1];
    is_foreign[k - 1] = is_foreign[other];
    is_foreign[other] = last;
  }
  return is_foreign;
}

Result<void> check(const SimulateOptions& o) {
  for (const auto& row : simulate_options_table().rows) {
    const auto number = std::visit(
        [&o](auto member) -> std::optional<double> {
          using T = std::decay_t<decltype(o.*member)>;
          if constexpr (std::is_same_v<T, int> || std::is_same_v<T, double>) return static_cast<double>(o.*member);
          if constexpr (std::is_same_v<T, std::optional<double>>) return o.*member;
          return std::nullopt;
        },
        row.member);
    if (number && !(*number >= row.min && *number <= row.max)) {
      return fail(fmt::format("{} = {} is outside {} to {}", row.key, *number, row.min, row.max), "simulate", row.help);
    }
    const auto* text = std::get_if<std::string SimulateOptions::*>(&row.member);
    if (text != nullptr && !row.choices.empty() && std::ranges::find(row.choices, o.*(*text)) == row.choices.end()) {
      return fail(fmt::format("{} = '{}' is unknown", row.key, o.*(*text)), "simulate",
                  fmt::format("one of {}", fmt::join(row.choices, ", ")));
    }
  }
  if (o.output.empty()) return fail("no output folder is named", "simulate", "-o DIR");
  return {};
}

/// A place of another kind and seed, with one station: nothing of it overlaps the survey.
Result<Place> make_foreign_place(int k, const SimulateOptions& o) {
  const auto& kinds = sim::scene_names();
  const std::uint64_t seed = seed_of(static_cast<std::uint64_t>(o.seed), fmt::format("foreign {}", k));
  const std::string& kind = kinds[static_cast<std::size_t>(seed % kinds.size())];
  return make_place(kind, {1, sim::default_spacing_m(kind), seed});
}

}  // namespace

Result<SimulationSummary> simulate(const SimulateOptions& o, const SimulationProgress& progress) {
  if (const Result<void> ok = check(o); !ok) return tl::unexpected(ok.error());
  const std::filesystem::path folder = o.output;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail("cannot create the folder: " + error.message(), folder.string());

  SimulationSummary summary;
  summary.spacing_m = o.spacing_m.value_or(sim::default_spacing_m(o.scene));
  const auto seed = static_cast<std::uint64_t>(o.seed);
  const Result<Place> home = make_place(o.scene, {o.stations, summary.spacing_m, seed});
  if (!home) return tl::unexpected(home.error());
  summary.num_triangles = home->solids.mesh().triangles.size();

  std::string poses, foreign_names;
  const std::vector<bool> is_foreign = scatter_foreign(o.stations, o.foreign, seed);
  const sim::Grid grid = sim::grid_of(o.resolution_deg * kRadPerDeg);
  int num_home = 0, num_foreign = 0;
  for (std::size_t k = 0; k < is_foreign.size(); ++k) {
    std::optional<Place> elsewhere;
    if (is_foreign[k]) {
      Result<Place> other = make_foreign_place(num_foreign++, o);
      if (!other) return tl::unexpected(other.error());
      elsewhere = std::move(*other);
    }
    const Place& place = elsewhere ? *elsewhere : *home;
    const Vector3d& centre = elsewhere ? place.stations.front() : place.stations[static_cast<std::size_t>(num_home++)];
    const std::uint64_t scan_seed = seed_of(seed, fmt::format("scan {}", k));
    const sim::Station station = set_up(centre, o, scan_seed);
    Result<void> status;
    const io::PointChunk points = scan_place(place, station, o, scan_seed, status);
    if (!status) return tl::unexpected(status.error());
    SimulatedScan scan{fmt::format("scan_{:03}.{}", k, o.format), static_cast<std::uint64_t>(grid.rows) * grid.columns,
                       points.points.size(), is_foreign[k]};
    if (const auto ok = io::write_scan(folder / scan.name, points); !ok) return tl::unexpected(ok.error());
    if (is_foreign[k]) {
      foreign_names += scan.name + "\n";
    } else {
      poses += pose_line(scan.name, station);
    }
    summary.scans.push_back(scan);
    if (progress) progress(scan, k + 1, is_foreign.size());
  }
  if (const auto ok = write_file_atomically(folder / "poses.gt.txt", poses); !ok) return tl::unexpected(ok.error());
  if (o.foreign > 0) {
    if (const auto ok = write_file_atomically(folder / "foreign.txt", foreign_names); !ok)
      return tl::unexpected(ok.error());
  }
  return summary;
}

}  // namespace isthmus
