#include "pipelines/job.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <array>

#include "base/atomic_file.h"
#include "base/digest.h"
#include "config/describe.h"
#include "config/yaml.h"
#include "isthmus_version.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

/// A word or a list of words under `key`; an error when it is missing or empty.
Result<std::vector<std::string>> words_of(const YAML::Node& job, const std::string& key, const std::string& file) {
  if (!job[key] || job[key].IsNull()) {
    return fail(fmt::format("the job has no '{}'", key), config::place(file, job.Mark()),
                "a job needs input and output");
  }
  Result<config::Written> written = config::written_in(job[key], file);
  if (!written) return tl::unexpected(written.error());
  if (written->words.empty()) return fail(fmt::format("'{}' is empty", key), config::place(file, job[key].Mark()));
  return std::move(written->words);
}

/// Profiles are names or files beside the job file.
Result<void> apply_profiles(const YAML::Node& job, const fs::path& file, Settings& settings) {
  if (!job["profile"]) return {};
  const Result<std::vector<std::string>> profiles = words_of(job, "profile", file.string());
  if (!profiles) return tl::unexpected(profiles.error());
  for (const std::string& profile : *profiles) {
    const fs::path beside = file.parent_path() / profile;
    std::error_code error;
    Result<void> done = apply_config(settings, fs::exists(beside, error) ? beside.string() : profile);
    if (!done) {
      if (done.error().where == profile) done.error().where = config::place(file.string(), job["profile"].Mark());
      return done;
    }
  }
  return {};
}

Result<Job> job_of(const YAML::Node& node, const fs::path& file) {
  static const std::array<std::string, 5> kKeys = {"input", "output", "control", "profile", "settings"};
  const std::string name = file.string();
  if (const Result<void> known = config::check_keys(node, kKeys, name); !known) return tl::unexpected(known.error());
  Job job;
  job.origin = fmt::format("{}:{}", name, node.Mark().line + 1);
  const auto beside = [&](const fs::path& path) { return (file.parent_path() / path).lexically_normal(); };
  const Result<std::vector<std::string>> inputs = words_of(node, "input", name);
  if (!inputs) return tl::unexpected(inputs.error());
  for (const std::string& input : *inputs) job.inputs.push_back(beside(input));
  const Result<std::vector<std::string>> output = words_of(node, "output", name);
  if (!output) return tl::unexpected(output.error());
  if (output->size() != 1) return fail("a job has one output", config::place(name, node["output"].Mark()));
  job.output = beside(output->front());
  if (node["control"] && !node["control"].IsNull()) {
    const Result<std::vector<std::string>> control = words_of(node, "control", name);
    if (!control) return tl::unexpected(control.error());
    if (control->size() != 1) return fail("a job has one control file", config::place(name, node["control"].Mark()));
    job.control = beside(control->front());
  }
  if (const Result<void> done = apply_profiles(node, file, job.settings); !done) return tl::unexpected(done.error());
  if (node["settings"]) {
    std::vector<config::Stage> stages = job.settings.stages();
    const Result<void> done = config::apply_yaml(node["settings"], stages, name, job.settings.origins);
    if (!done) return tl::unexpected(done.error());
  }
  for (std::string* path : job.settings.paths())
    if (!path->empty()) *path = beside(*path).string();
  return job;
}

/// Two spellings of one folder are the same: "out", "./out/", a link to it.
fs::path one_spelling(const fs::path& folder) {
  std::error_code error;
  const fs::path absolute = fs::absolute(folder, error);
  fs::path path = fs::weakly_canonical(absolute, error);
  if (error) path = absolute.lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// Relative to the folder, so that input and output may move together.
std::string relative_path(const fs::path& path, const fs::path& folder) {
  const fs::path relative =
      fs::absolute(path).lexically_normal().lexically_relative(fs::absolute(folder).lexically_normal());
  return relative.empty() ? fs::absolute(path).string() : relative.string();
}

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

Result<std::vector<Job>> read_jobs(const fs::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const Result<YAML::Node> node = config::parse_yaml(*text, file.string());
  if (!node) return tl::unexpected(node.error());
  std::vector<Job> jobs;
  const auto add = [&](const YAML::Node& one) -> Result<void> {
    Result<Job> job = job_of(one, file);
    if (!job) return tl::unexpected(job.error());
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (one_spelling(jobs[i].output) != one_spelling(job->output)) continue;
      return fail(fmt::format("job {} and job {} (at {}) write to the same folder {}", jobs.size() + 1, i + 1,
                              jobs[i].origin, job->output.string()),
                  config::place(file.string(), one["output"].Mark()), "give each job an output of its own");
    }
    jobs.push_back(std::move(*job));
    return {};
  };
  if (!node->IsSequence()) {
    if (const Result<void> done = add(*node); !done) return tl::unexpected(done.error());
    return jobs;
  }
  for (const auto& one : *node) {
    if (const Result<void> done = add(one); !done) return tl::unexpected(done.error());
  }
  if (jobs.empty()) return fail("the list of jobs is empty", file.string());
  return jobs;
}

std::string resolved_job(const Job& job, const fs::path& folder) {
  std::string out = fmt::format(
      "# The job as it was run by isthmus {}; 'isthmus run' on this file repeats it.\n"
      "# Behind each value stands where it came from.\n",
      kVersion);
  if (job.inputs.size() == 1) {
    out += fmt::format("input: {}\n", in_quotes(relative_path(job.inputs[0], folder)));
  } else {
    out += "input:\n";
    for (const fs::path& input : job.inputs) out += fmt::format("  - {}\n", in_quotes(relative_path(input, folder)));
  }
  out += fmt::format("output: {}\n", in_quotes(relative_path(job.output, folder)));
  if (!job.control.empty()) out += fmt::format("control: {}\n", in_quotes(relative_path(job.control, folder)));
  out += "settings:\n";
  Settings settings = job.settings;
  for (std::string* path : settings.paths())
    if (!path->empty()) *path = relative_path(*path, folder);
  return out + config::resolved_yaml(settings.stages(), settings.origins, 2);
}

std::string plan_word(const Job& job) {
  Settings settings = job.settings;
  std::vector<config::Stage> stages = settings.stages();
  std::erase_if(stages, [](const config::Stage& stage) { return stage.name == run_options_table().stage; });
  Digest digest;
  digest.add(config::values_yaml(stages)).add(store_folder(job).lexically_normal().string());
  for (const fs::path& input : job.inputs) digest.add(fs::absolute(input).lexically_normal().string());
  digest.add(kVersion).add(static_cast<std::uint64_t>(job.share.count));
  constexpr std::size_t kDigits = 16;
  return digest.hex().substr(0, kDigits);
}

fs::path store_folder(const Job& job) {
  return job.settings.run.store.empty() ? job.output / "store" : fs::path(job.settings.run.store);
}

}  // namespace isthmus::pipelines
