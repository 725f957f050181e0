#include "settings_flags.h"
#include "number_checks.h"

#include <CLI/CLI.hpp>
#include <filesystem>

namespace isthmus::cli {

void SettingsFlags::add_config(CLI::App& command) {
  command
      .add_option("-c,--config", configs, "Configuration file (YAML) or built-in profile; may be given several times")
      ->type_name("FILE")
      ->take_all();
}

void SettingsFlags::add_overrides(CLI::App& command) {
  command
      .add_option("--set", assignments, "One setting, such as sampling.voxel_m=0.1; 'isthmus config default' lists all")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--threads", threads, "Threads that compute at the same time (default: one a core)")
      ->type_name("N");
  command.add_option("--memory", memory_gb, "Memory for scans and pairs in work, GB (default: half of the machine's)")
      ->type_name("GB");
}

void SettingsFlags::add_store(CLI::App& command) {
  command.add_option("--store", store, "Folder that keeps what was computed; several outputs may share one")
      ->type_name("DIR");
}

void SettingsFlags::add_shard(CLI::App& command) {
  command
      .add_option("--shard", shard,
                  "Do the K-th of N shares of the work, beside other processes or machines that do the others with the "
                  "same store; the same command without it collects the results")
      ->type_name("K/N");
  command
      .add_option("--wait", wait_s,
                  "A shard that needs what others have not made yet gives up when nothing came for so long (default: "
                  "600); it can be run again")
      ->type_name("SECONDS")
      ->check(not_negative());
}

Result<void> SettingsFlags::apply(pipelines::Job& job) const {
  job.wait_s = wait_s;
  if (!shard.empty()) {
    const Result<pipelines::Share> share = pipelines::Share::parse(shard);
    if (!share) return tl::unexpected(share.error());
    job.share = *share;
  }
  return apply(job.settings);
}

Result<pipelines::Job> SettingsFlags::job(const std::vector<std::string>& inputs, const std::string& output) const {
  pipelines::Job job;
  job.origin = "command line";
  job.inputs.assign(inputs.begin(), inputs.end());
  job.output = output;
  if (const Result<void> good = apply(job); !good) return tl::unexpected(good.error());
  return job;
}

Result<void> SettingsFlags::apply(pipelines::Settings& settings) const {
  for (const std::string& config : configs) {
    if (const Result<void> done = pipelines::apply_config(settings, config); !done) return done;
  }
  std::vector<std::string> all = assignments;
  if (!threads.empty()) all.push_back("run.threads=" + threads);
  if (!memory_gb.empty()) all.push_back("run.memory_gb=" + memory_gb);
  if (const Result<void> done = pipelines::apply_assignments(settings, all); !done) return done;
  if (!store.empty()) {
    settings.run.store = store;
    settings.origins["run.store"] = "--store";
  }
  return {};
}

}  // namespace isthmus::cli
