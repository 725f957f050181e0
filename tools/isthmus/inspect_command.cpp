// isthmus inspect: what is in a scan file?
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "exit_codes.h"
#include "io/inspect.h"
#include "io/scan_directory.h"
#include "terminal.h"

namespace isthmus::cli {
namespace {

/// All scans of a file, or the one that is named with "#k".
Result<std::vector<io::ScanRef>> scans_named(const std::string& text) {
  std::error_code error;
  if (std::filesystem::exists(text, error)) return io::scans_of_file(text);
  const Result<io::ScanRef> one = io::resolve_scan_name(text);
  if (!one) return tl::unexpected(one.error());
  return std::vector<io::ScanRef>{*one};
}

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("{:.10g} {:.10g} {:.10g}", v.x(), v.y(), v.z());
}

void print_pose(const Transform& file_from_scan) {
  for (int r = 0; r < 3; ++r) {
    fmt::print("{}{:.10g} {:.10g} {:.10g} {:.10g}\n", r == 0 ? "  pose       " : "             ", file_from_scan(r, 0),
               file_from_scan(r, 1), file_from_scan(r, 2), file_from_scan(r, 3));
  }
}

void print_summary(const std::string& title, const io::ScanSummary& summary) {
  fmt::print("{}\n  format     {}\n  points     {}\n", title, summary.header.format, summary.num_read);
  if (summary.num_finite != summary.num_read) fmt::print("  invalid    {}\n", summary.num_read - summary.num_finite);
  if (summary.extent_in_scan) {
    fmt::print("  from       {}\n  to         {}\n  extent     {} m\n", vector_text(summary.extent_in_scan->min()),
               vector_text(summary.extent_in_scan->max()), vector_text(summary.extent_in_scan->sizes()));
  }
  if (summary.spacing_m) fmt::print("  spacing    {:.3g} m\n", *summary.spacing_m);
  if (summary.intensity_range) {
    fmt::print("  intensity  {:g} to {:g}\n", summary.intensity_range->first, summary.intensity_range->second);
  }
  fmt::print("  colour     {}\n", summary.header.has_colour ? "yes" : "no");
  if (summary.header.station_in_scan) fmt::print("  station    {}\n", vector_text(*summary.header.station_in_scan));
  if (summary.header.file_from_scan) print_pose(*summary.header.file_from_scan);
  for (const std::string& note : summary.header.notes) fmt::print("  note       {}\n", note);
}

/// False if the file, or a scan in it, is unreadable.
bool inspect(const std::string& text, Terminal& terminal) {
  const Result<std::vector<io::ScanRef>> scans = scans_named(text);
  if (!scans) {
    terminal.error(scans.error());
    return false;
  }
  bool good = true;
  for (const io::ScanRef& scan : *scans) {
    const Result<io::ScanSummary> summary = io::inspect_scan(scan);
    if (!summary) {
      terminal.error(summary.error());
      good = false;
      continue;
    }
    const std::string title = scans->size() > 1 ? fmt::format("{}#{}", text, scan.index) : text;
    print_summary(title, *summary);
  }
  return good;
}

}  // namespace

void add_inspect(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("inspect", "Say what scan files hold: format, points, extent, spacing, station");
  auto files = std::make_shared<std::vector<std::string>>();
  command->add_option("FILE", *files, "Scan files; file#k names one of the scans in a file")->required();
  command->callback([files, &exit_code] {
    Terminal terminal;
    for (const std::string& file : *files) {
      if (!inspect(file, terminal)) exit_code = kFailure;
    }
  });
}

}  // namespace isthmus::cli
