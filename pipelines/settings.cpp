#include "pipelines/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "base/atomic_file.h"
#include "config/nearest_word.h"
#include "config/yaml.h"
#include "pipelines/profiles.h"

namespace isthmus::pipelines {
namespace {

constexpr double kBytesPerGigabyte = 1e9;

/// The machine's memory, or less where the process is confined (cgroup v2).
std::size_t bytes_of_machine() {
  const auto physical =
      static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::size_t confined = 0;
  std::ifstream limit("/sys/fs/cgroup/memory.max");
  if (limit >> confined && confined > 0) return std::min(physical, confined);  // "max" does not read as a number
  return physical;
}

Result<void> apply_text(Settings& settings, const std::string& yaml, const std::string& file) {
  const Result<YAML::Node> node = config::parse_yaml(yaml, file);
  if (!node) return tl::unexpected(node.error());
  std::vector<config::Stage> stages = settings.stages();
  return config::apply_yaml(*node, stages, file, settings.origins);
}

}  // namespace

const config::OptionTable<RunOptions>& run_options_table() {
  constexpr double kMostThreads = 4096;  // more than any machine of 2025 has
  constexpr double kMostMemoryGb = 1e6;
  static const config::OptionTable<RunOptions> table{
      "run",
      "How a run is carried out; nothing here changes a result.",
      {{"threads",
        &RunOptions::threads,
        "",
        1,
        kMostThreads,
        {},
        "Threads that compute at the same time.",
        "auto: one for each core of the machine.",
        false},
       {"memory_gb",
        &RunOptions::memory_gb,
        "GB",
        0.1,
        kMostMemoryGb,
        {},
        "Memory that scans and pairs in work may hold together. One that needs more still runs, alone.",
        "auto: half of the machine's memory, so that the page cache and other programs keep the rest.",
        false},
       {"store",
        &RunOptions::store,
        "",
        0,
        0,
        {},
        "Folder that keeps what was computed of each scan and pair. Several outputs may share one; empty means the "
        "folder "
        "store within the output.",
        "A rerun of the same output then goes on where it stopped without a flag.",
        false}}};
  return table;
}

std::vector<config::Stage> Settings::stages() {
  return {config::bind(sampling_options_table(), sampling),
          config::bind(feature_options_table(), features),
          config::bind(region_options_table(), regions),
          config::bind(candidate_options_table(), candidates),
          config::bind(pair_options_table(), pair),
          config::bind(solve_options_table(), solve),
          config::bind(run_options_table(), run)};
}

SettingsDigests digests_of(Settings settings) {
  return {config::settings_digest(config::bind(sampling_options_table(), settings.sampling)),
          config::settings_digest(config::bind(feature_options_table(), settings.features)),
          config::settings_digest(config::bind(region_options_table(), settings.regions)),
          config::settings_digest(config::bind(pair_options_table(), settings.pair))};
}

int threads_of(const RunOptions& run) {
  return run.threads.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

std::size_t memory_bytes_of(const RunOptions& run) {
  return run.memory_gb ? static_cast<std::size_t>(*run.memory_gb * kBytesPerGigabyte) : bytes_of_machine() / 2;
}

Result<void> apply_config(Settings& settings, const std::string& file_or_profile) {
  std::error_code error;
  if (std::filesystem::exists(file_or_profile, error)) {
    const Result<std::string> text = read_file(file_or_profile);
    if (!text) return tl::unexpected(text.error());
    return apply_text(settings, *text, file_or_profile);
  }
  for (const Profile& profile : profiles()) {
    if (profile.name == file_or_profile) {
      return apply_text(settings, std::string(profile.yaml), fmt::format("profile {}", profile.name));
    }
  }
  const std::vector<std::string> names = profile_names();
  const std::string nearest = config::nearest_word(file_or_profile, names);
  return fail(
      "there is no such configuration file or profile", file_or_profile,
      nearest.empty() ? fmt::format("profiles: {}", fmt::join(names, ", ")) : fmt::format("did you mean {}?", nearest));
}

Result<void> apply_assignments(Settings& settings, const std::vector<std::string>& assignments) {
  std::vector<config::Stage> stages = settings.stages();
  for (const std::string& assignment : assignments) {
    if (const Result<void> done = config::apply_assignment(stages, assignment, settings.origins); !done) return done;
  }
  return {};
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const Profile& profile : profiles()) {
    if (profile.name != "default") names.emplace_back(profile.name);
  }
  return names;
}

}  // namespace isthmus::pipelines
