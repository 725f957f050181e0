#include "simulate/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "base/atomic_file.h"
#include "base/disk_space.h"
#include "base/rng.h"
#include "config/describe.h"
#include "io/scan_writer.h"
#include "simulate/movers.h"
#include "simulate/scanner.h"
#include "simulate/scene.h"
#include "simulate/stations.h"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

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

Result<io::PointChunk> scan_place(const Place& place, const sim::Station& station, const SimulateOptions& o,
                                  std::uint64_t seed) {
  sim::Mesh moving;
  if (o.movers) {
    Rng rng(seed_of(seed, "movers"));
    moving = sim::movers_around(station.common_from_instrument.translation(), place.scene, place.solids, rng);
  }
  const bool something_moves = !moving.triangles.empty();
  const Result<RayScene> moved = RayScene::build(std::move(moving));
  if (!moved) return tl::unexpected(moved.error());
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
  if (o.min_range_m >= o.max_range_m) {
    return fail(fmt::format("min_range_m = {} is not below max_range_m = {}", o.min_range_m, o.max_range_m), "simulate",
                "every return would be cut");
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

constexpr const char* kRecord = "simulation.yaml";

std::string scan_file(std::size_t number, const SimulateOptions& o) {
  return fmt::format("scan_{:03}.{}", number, o.format);
}

/// One scan on disk and the truth about it.
struct WrittenScan {
  SimulatedScan scan;
  std::string pose;  ///< its line of poses.gt.txt
};

Result<WrittenScan> write_scan_of(const Place& place, const Vector3d& centre, std::size_t number,
                                  const SimulateOptions& o) {
  const std::uint64_t seed = seed_of(static_cast<std::uint64_t>(o.seed), fmt::format("scan {}", number));
  const sim::Station station = set_up(centre, o, seed);
  const Result<io::PointChunk> points = scan_place(place, station, o, seed);
  if (!points) return tl::unexpected(points.error());
  const sim::Grid grid = sim::grid_of(o.resolution_deg * kRadPerDeg);
  WrittenScan written;
  written.scan.name = scan_file(number, o);
  written.scan.num_rays = static_cast<std::uint64_t>(grid.rows) * static_cast<std::uint64_t>(grid.columns);
  written.scan.num_points = points->points.size();
  written.pose = pose_line(written.scan.name, station);
  const Result<void> done = io::write_scan(std::filesystem::path(o.output) / written.scan.name, *points);
  if (!done) return tl::unexpected(done.error());
  return written;
}

/// The files that an earlier simulation says in its record it made here.
Result<std::vector<fs::path>> files_of_record(const fs::path& folder) {
  const Result<std::string> text = read_file(folder / kRecord);
  if (!text) return tl::unexpected(text.error());
  std::vector<fs::path> files;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  - ")) continue;
    const fs::path name = line.substr(4);
    std::error_code error;
    const bool is_ours = name == name.filename() && !fs::is_directory(folder / name, error);
    if (is_ours) files.push_back(folder / name);
  }
  return files;
}

/// A simulation makes a folder of its own: what it made there before goes, and what somebody else put there is not
/// touched, since its scans would pass for scans of this survey.
Result<void> make_room(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    return fail("is a file, a folder is wanted", folder.string(), "name a new folder with -o");
  }
  fs::create_directories(folder, error);
  if (error) return tl::unexpected(write_error("the folder cannot be created", error.value(), folder));
  if (fs::is_empty(folder, error)) return {};
  if (!fs::exists(folder / kRecord, error)) {
    return fail("the folder is not empty and was not made by simulate", folder.string(),
                "name a new folder with -o, or empty this one");
  }
  const Result<std::vector<fs::path>> files = files_of_record(folder);
  if (!files) return tl::unexpected(files.error());
  for (const fs::path& file : *files) {
    fs::remove(file, error);
    if (error)
      return tl::unexpected(write_error("an earlier simulation's file cannot be removed", error.value(), file));
  }
  return {};
}

/// What the folder was made by, and which files are the simulation's: a later one replaces those and no others.
Result<void> write_record(const SimulateOptions& o, std::size_t num_scans) {
  SimulateOptions options = o;
  options.output.clear();  // the record does not depend on where it lies
  std::string text =
      "# Made by 'isthmus simulate'; a later simulation into this folder replaces the files listed here.\n";
  const std::array<config::Stage, 1> stages = {config::bind(simulate_options_table(), options)};
  text += config::values_yaml(stages);
  text += "files:\n  - poses.gt.txt\n  - foreign.txt\n";
  for (std::size_t k = 0; k < num_scans; ++k) text += fmt::format("  - {}\n", scan_file(k, o));
  return write_file_atomically(fs::path(o.output) / kRecord, text);
}

Result<void> write_truth(const SimulateOptions& o, const std::string& poses, const std::string& foreign_names) {
  const std::filesystem::path folder = o.output;
  if (const Result<void> done = write_file_atomically(folder / "poses.gt.txt", poses); !done) return done;
  return o.foreign > 0 ? write_file_atomically(folder / "foreign.txt", foreign_names) : Result<void>{};
}

}  // namespace

Result<SimulationSummary> simulate(const SimulateOptions& o, const SimulationProgress& progress) {
  if (const Result<void> good = check(o); !good) return tl::unexpected(good.error());
  if (const Result<void> room = make_room(o.output); !room) return tl::unexpected(room.error());

  SimulationSummary summary;
  summary.spacing_m = o.spacing_m.value_or(sim::default_spacing_m(o.scene));
  const auto seed = static_cast<std::uint64_t>(o.seed);
  const Result<Place> home = make_place(o.scene, {o.stations, summary.spacing_m, seed});
  if (!home) return tl::unexpected(home.error());
  summary.num_triangles = home->solids.mesh().triangles.size();

  std::string poses, foreign_names;
  int num_foreign = 0;
  const std::vector<bool> is_foreign = scatter_foreign(o.stations, o.foreign, seed);
  if (const Result<void> done = write_record(o, is_foreign.size()); !done) return tl::unexpected(done.error());
  for (std::size_t k = 0; k < is_foreign.size(); ++k) {
    Result<WrittenScan> written;
    if (is_foreign[k]) {
      const Result<Place> elsewhere = make_foreign_place(num_foreign++, o);
      if (!elsewhere) return tl::unexpected(elsewhere.error());
      written = write_scan_of(*elsewhere, elsewhere->stations.front(), k, o);
    } else {
      written = write_scan_of(*home, home->stations[k - static_cast<std::size_t>(num_foreign)], k, o);
    }
    if (!written) return tl::unexpected(written.error());
    written->scan.foreign = is_foreign[k];
    (is_foreign[k] ? foreign_names : poses) += is_foreign[k] ? written->scan.name + "\n" : written->pose;
    summary.scans.push_back(written->scan);
    if (progress) progress(written->scan, k + 1, is_foreign.size());
  }
  if (const Result<void> done = write_truth(o, poses, foreign_names); !done) return tl::unexpected(done.error());
  return summary;
}

}  // namespace isthmus
