// isthmus export: the poses of a finished survey, and its scans with their poses, for other programs.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "commands.h"
#include "exit_codes.h"
#include "io/crs.h"
#include "io/format_table.h"
#include "io/scan_directory.h"
#include "io/wording.h"
#include "number_checks.h"
#include "pipelines/job.h"
#include "pipelines/merged_export.h"
#include "pipelines/ptx_export.h"
#include "report/pose_exports.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

namespace fs = std::filesystem;

/// The folder that the names of the scans are relative to, by resolved.yaml, which says where they lie from OUT
/// (run.json has it as it was typed, from wherever that was).
Result<fs::path> input_folder(const fs::path& out) {
  constexpr const char* kHint = "name it: --scans DIR";
  const fs::path file = out / "resolved.yaml";
  const Result<std::vector<pipelines::Job>> jobs = pipelines::read_jobs(file);
  if (!jobs) return fail(jobs.error().what, jobs.error().where, kHint);
  const std::vector<fs::path>& inputs = jobs->front().inputs;
  std::error_code error;
  for (const fs::path& input : inputs)
    if (!fs::exists(input, error)) return fail("the scans are not there any more", input.string(), kHint);
  if (inputs.size() == 1 && fs::is_directory(inputs[0], error)) return inputs[0];
  const Result<io::ScanListing> listing = io::list_scans(inputs);
  if (!listing) return tl::unexpected(listing.error());
  return listing->base;
}

/// What is written is what the name says.
CLI::Validator ends_in_ptx() {
  return {[](const std::string& file) {
            return io::lower_case(fs::path(file).extension().string()) == ".ptx" ? std::string()
                                                                                 : file + " does not end in .ptx";
          },
          ""};
}

CLI::Validator e57_or_folder() {
  return {[](const std::string& path) -> std::string {
            std::error_code error;
            const auto format = io::format_of(path);
            if (!format || (*format)->name == std::string_view("e57") || fs::is_directory(path, error)) return "";
            return path + " is no name for E57: name FILE.e57, or a folder";
          },
          ""};
}

struct ExportRun {
  std::string out;
  std::string poses;
  std::string file;
  std::string e57;
  std::string ptx;
  std::string merged;
  std::optional<double> voxel_m;
  std::string crs;
  std::string scans;
  int component = 0;

  bool wants_scans() const { return !e57.empty() || !ptx.empty() || !merged.empty(); }

  int run() const {
    Terminal terminal;
    const auto survey = report::read_finished_survey(out);
    const Result<void> done = survey ? export_all(*survey, terminal) : tl::unexpected(survey.error());
    if (done) return kSuccess;
    terminal.error(done.error());
    return kFailure;
  }

 private:
  Result<void> export_all(const report::FinishedSurvey& survey, Terminal& terminal) const {
    if (component >= survey.num_components()) {
      return fail(fmt::format("the survey has {} components, there is no {}", survey.num_components(), component), out,
                  "components are counted from 0, the largest");
    }
    std::size_t elsewhere = 0;
    for (const report::FinishedScan& scan : survey.scans) elsewhere += scan.component != component ? 1 : 0;
    if (elsewhere > 0) {
      terminal.warn(
          fmt::format("{} scans in other components have another frame and are left out (--component K)", elsewhere));
    }
    if (auto written = poses.empty() ? Result<void>() : write_poses(survey); !written) return written;
    return wants_scans() ? write_scans(survey, terminal) : Result<void>();
  }

  Result<void> write_poses(const report::FinishedSurvey& survey) const {
    const report::PoseFormat format = *report::pose_format(poses);
    if (report::has_file_per_scan(format)) {
      if (file.empty())
        return fail("this format has files for each scan", "--poses " + poses, "name a folder: -o FOLDER");
      return write_files(file, report::export_pose_files(survey, component, format));
    }
    const std::string text = report::export_poses(survey, component, format);
    if (!file.empty()) return write_file_atomically(file, text);
    fmt::print("{}", text);
    return {};
  }

  static Result<void> write_files(const fs::path& folder, const std::vector<report::PoseFile>& files) {
    for (const report::PoseFile& pose : files) {
      const fs::path path = folder / pose.name;
      std::error_code error;
      fs::create_directories(path.parent_path(), error);
      if (error) return fail("folder cannot be created: " + error.message(), path.parent_path().string());
      if (Result<void> written = write_file_atomically(path, pose.text); !written) return written;
    }
    return {};
  }

  /// The component's scans where they lie, and the folder they lie in.
  Result<std::pair<fs::path, std::vector<pipelines::SourcedScan>>> placed_scans(
      const report::FinishedSurvey& survey) const {
    const Result<fs::path> base = scans.empty() ? input_folder(out) : Result<fs::path>(fs::path(scans));
    if (!base) return tl::unexpected(base.error());
    std::vector<pipelines::SourcedScan> placed;
    for (const report::FinishedScan& scan : survey.scans) {
      if (scan.component != component) continue;
      Result<io::ScanRef> ref = io::resolve_scan_name((*base / scan.name).string());
      if (!ref) return tl::unexpected(std::move(ref.error()));
      if (scan.id >= std::numeric_limits<std::uint16_t>::max())
        return fail("sources are counted up to 65535", out, "export components or parts");
      ref->name = scan.name;
      placed.push_back({{std::move(*ref), scan.component_from_scan}, static_cast<std::uint16_t>(scan.id + 1)});
    }
    return std::pair(*base, std::move(placed));
  }

  Result<void> write_scans(const report::FinishedSurvey& survey, Terminal& terminal) const {
    const auto scans_of_part = placed_scans(survey);
    if (!scans_of_part) return tl::unexpected(scans_of_part.error());
    const auto& [base, sourced] = *scans_of_part;
    std::vector<pipelines::PlacedScan> placed;
    for (const pipelines::SourcedScan& scan : sourced) placed.push_back(scan.placed);
    Result<std::optional<io::Crs>> system = reference_system();
    if (!system) return tl::unexpected(std::move(system.error()));
    if (*system) warn_of_own_frame(terminal);
    const std::string coordinates = *system ? (*system)->text : std::string();
    if (auto done = e57.empty() ? Result<void>() : write_e57(base, placed, coordinates, terminal); !done) return done;
    if (!ptx.empty()) {
      if (auto done = pipelines::export_ptx(ptx, placed); !done) return done;
      terminal.say(fmt::format("{} scans in {}", placed.size(), ptx));
    }
    if (merged.empty()) return {};
    const Result<std::uint64_t> count = pipelines::export_merged(merged, sourced, {voxel_m, *system});
    if (!count) return tl::unexpected(count.error());
    terminal.say(fmt::format("{} points of {} scans in {}", *count, placed.size(), merged));
    return {};
  }

  /// As named, or from the file that is named.
  Result<std::optional<io::Crs>> reference_system() const {
    if (crs.empty()) return std::optional<io::Crs>();
    std::error_code error;
    const bool in_file = fs::is_regular_file(crs, error);
    const Result<std::string> text = in_file ? read_file(crs) : Result<std::string>(crs);
    if (!text) return tl::unexpected(text.error());
    Result<io::Crs> parsed = io::parse_crs(*text);
    if (parsed) return std::optional<io::Crs>(std::move(*parsed));
    return fail(parsed.error().what + (in_file ? "" : ", and there is no such file"), in_file ? crs : "--crs",
                parsed.error().hint);
  }

  /// A reference system said of coordinates that are not in it misleads whoever opens the file.
  void warn_of_own_frame(Terminal& terminal) const {
    const Result<std::string> text = read_file(fs::path(out) / "run.json");
    const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    if (!json.is_object() || !json.contains("components") || !json["components"].is_array()) return;
    const auto& all = json["components"];
    const auto k = static_cast<std::size_t>(component);
    if (k >= all.size() || !all[k].is_object() || all[k].value("frame", "") == "world") return;
    terminal.warn(
        "the coordinates are those of the first scan, not of a map: --crs is written all the same (a survey is "
        "laid into a map by 'isthmus solve --control')");
  }

  Result<void> write_e57(const fs::path& base, const std::vector<pipelines::PlacedScan>& placed,
                         const std::string& coordinates, Terminal& terminal) const {
    if (io::lower_case(fs::path(e57).extension().string()) == ".e57") {
      auto written = pipelines::export_e57_file(e57, placed, coordinates);
      if (written) terminal.say(fmt::format("{} scans in {}", placed.size(), e57));
      return written;
    }
    const auto written = pipelines::export_e57_folder(e57, base, placed, coordinates);
    if (!written) return tl::unexpected(written.error());
    terminal.say(fmt::format("{} scans in {} files in {}", placed.size(), written->size(), e57));
    return {};
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("export", "Write a finished survey's poses or scans for other programs");
  auto run = std::make_shared<ExportRun>();
  command->add_option("OUT", run->out, "Output folder of 'register'")->required();
  CLI::Option* poses =
      command
          ->add_option("--poses", run->poses,
                       "Poses as open3d (PoseGraph JSON, with the links), tum, kitti, csv, 3dtk or riscan")
          ->type_name("FORMAT")
          ->check(CLI::IsMember({"open3d", "tum", "kitti", "csv", "3dtk", "riscan"}));
  command
      ->add_option("-o,--output", run->file,
                   "File for the poses (default: standard output); folder for 3dtk and riscan")
      ->type_name("FILE")
      ->needs(poses);
  command->add_option("--e57", run->e57, "Scans with their poses as E57: all in FILE.e57, or one file each in a folder")
      ->type_name("PATH")
      ->check(e57_or_folder());
  command->add_option("--ptx", run->ptx, "Scans with their poses filled in as one PTX file")
      ->type_name("FILE.ptx")
      ->check(ends_in_ptx());
  CLI::Option* merged =
      command
          ->add_option("--merged", run->merged,
                       "All scans as one cloud: FILE.las, .laz, .ply or .pcd; as stations of FILE.e57")
          ->type_name("FILE")
          ->check([](const std::string& file) {
            return pipelines::knows_merged(file) ? std::string()
                                                 : file + " ends in none of .las, .laz, .ply, .pcd, .e57";
          });
  command->add_option("--voxel", run->voxel_m, "Keep one point of the merged cloud in each cube of this edge, metres")
      ->type_name("METRES")
      ->check(above_zero())
      ->needs(merged);
  command
      ->add_option("--crs", run->crs,
                   "Coordinate reference system for LAS, LAZ and E57 to state: EPSG:25832, EPSG:25832+7837, WKT, or a "
                   "file of WKT")
      ->type_name("SYSTEM");
  CLI::Option* scans = command
                           ->add_option("--scans", run->scans,
                                        "Folder of the scans (default: where they were read, by OUT/resolved.yaml)")
                           ->type_name("DIR");
  command->add_option("--component", run->component, "Which component (default: 0, the largest)")
      ->type_name("K")
      ->check(not_negative());
  command->callback([run, scans, &exit_code] {
    if (run->poses.empty() && !run->wants_scans()) throw CLI::RequiredError("--poses, --e57, --ptx or --merged");
    if (!run->crs.empty() && run->e57.empty() && run->merged.empty())
      throw CLI::RequiredError("--crs needs --merged or --e57");
    if (scans->count() > 0 && !run->wants_scans()) throw CLI::RequiredError("--scans needs --e57, --ptx or --merged");
    exit_code = run->run();
  });
}

}  // namespace isthmus::cli
