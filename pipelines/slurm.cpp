#include "pipelines/slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/atomic_file.h"
#include "base/disk_space.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kUsualMaxArraySize = 1001;  // Slurm's default
constexpr double kSecondsPerMinute = 60;

struct Said {
  int exit_code = -1;
  std::string text;
};

std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Standard output and error of a command.
Said said_by(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += quoted(word) + " ";
  FILE* pipe = ::popen((command + "2>&1").c_str(), "r");
  if (pipe == nullptr) return {};
  Said said;
  std::array<char, 4096> block{};
  while (const std::size_t n = std::fread(block.data(), 1, block.size(), pipe)) said.text.append(block.data(), n);
  const int status = ::pclose(pipe);
  said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  while (said.text.ends_with('\n')) said.text.pop_back();
  return said;
}

/// From "MaxArraySize            = 1001".
std::size_t max_array_size() {
  std::istringstream lines(said_by({"scontrol", "show", "config"}).text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("MaxArraySize")) continue;
    const std::size_t equals = line.find('=');
    if (equals != std::string::npos)
      return static_cast<std::size_t>(std::strtoul(line.c_str() + equals + 1, nullptr, 10));
  }
  return kUsualMaxArraySize;
}

fs::path jobs_file(const fs::path& output) { return output / "submit" / "jobs.txt"; }

/// Ids of the last submission.
std::vector<std::string> submitted_ids(const fs::path& output) {
  std::vector<std::string> ids;
  const Result<std::string> text = read_file(jobs_file(output));
  std::istringstream lines(text.value_or(""));
  for (std::string line; std::getline(lines, line);) {
    if (const std::string id = line.substr(0, line.find(' ')); !id.empty()) ids.push_back(id);
  }
  return ids;
}

Result<std::string> submit_one(const SlurmJob& job, const fs::path& output, const SlurmOptions& options,
                               const std::string& after) {
  const fs::path script = output / "submit" / (job.stage + ".sh");
  if (const Result<void> written = write_file_atomically(script, slurm_script(job, output, options)); !written) {
    return tl::unexpected(written.error());
  }
  std::vector<std::string> words = {"sbatch", "--parsable"};
  if (!after.empty()) words.push_back("--dependency=afterany:" + after);
  words.insert(words.end(), options.more.begin(), options.more.end());
  words.push_back(script.string());
  const Said said = said_by(words);
  if (said.exit_code != 0) return fail("sbatch refused: " + said.text, script.string());
  const std::string last_line = said.text.substr(said.text.rfind('\n') + 1);
  return last_line.substr(0, last_line.find(';'));  // "id;cluster" where there are several clusters
}

}  // namespace

std::vector<SlurmJob> slurm_jobs(const Outlook& outlook, const Job& job, const SlurmOptions& options,
                                 std::size_t max_array_size) {
  const auto most = std::min<std::size_t>(static_cast<std::size_t>(options.most_tasks),
                                          max_array_size > 1 ? max_array_size - 1 : 1);  // indices begin with 1
  const double work = outlook.seconds * threads_of(job.settings.run);                    // of one thread
  const std::size_t items = std::max<std::size_t>(1, outlook.scans_to_make + outlook.pairs_to_make);
  const double per_item = work / static_cast<double>(items);
  const auto tasks = [&](std::size_t count) {
    const double packed = std::ceil(static_cast<double>(count) * per_item / (options.task_minutes * kSecondsPerMinute));
    return std::clamp<std::size_t>(static_cast<std::size_t>(packed), 1,
                                   std::min(most, std::max<std::size_t>(1, count)));
  };
  std::vector<SlurmJob> jobs;
  if (outlook.scans_to_make > 0) {
    // The first time every task looks at its scans only, since the voxel follows from all of them.
    jobs.push_back({"", "look", tasks(outlook.scans_to_make)});
    jobs.push_back({"", "scans", tasks(outlook.scans_to_make)});
  }
  if (outlook.pairs_to_make > 0) {
    for (int round = 0; round < options.pair_rounds; ++round) {
      jobs.push_back({"", round == 0 ? "pairs" : fmt::format("pairs{}", round + 1), tasks(outlook.pairs_to_make)});
    }
  }
  jobs.push_back({"", "solve", 1});
  return jobs;
}

std::string slurm_script(const SlurmJob& job, const fs::path& output, const SlurmOptions& options) {
  const bool is_array = job.stage != "solve";
  const fs::path log = output / "submit" / (job.stage + (is_array ? "-%A_%a.log" : "-%j.log"));
  std::string script = "#!/bin/sh\n# Written by 'isthmus submit'.\n";
  script += fmt::format("#SBATCH --job-name=isthmus-{}\n#SBATCH --output={}\n#SBATCH --cpus-per-task={}\n", job.stage,
                        log.string(), options.cpus);
  script += "#SBATCH --ntasks=1\n#SBATCH --requeue\n#SBATCH --open-mode=append\n";
  if (!options.partition.empty()) script += fmt::format("#SBATCH --partition={}\n", options.partition);
  if (is_array) script += fmt::format("#SBATCH --array=1-{}\n", job.tasks);
  const std::string command = fmt::format("{} run {} --threads {}", quoted(options.program),
                                          quoted((output / "job.yaml").string()), options.cpus);
  if (!is_array) return script + fmt::format("exec {}\n", command);
  script += fmt::format("{} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --wait 0\n", command, job.tasks);
  // 4: the share is done and the next stage is another array's.
  return script + "code=$?\n[ $code -eq 4 ] && code=0\nexit $code\n";
}

Result<std::vector<SlurmJob>> submit_to_slurm(const Job& job, const SlurmOptions& options) {
  if (const Said said = said_by({"sbatch", "--version"}); said.exit_code != 0) {
    return fail("Slurm is not here: " + said.text, "sbatch", "without it, use --shard (docs/several_machines.md)");
  }
  const fs::path output = fs::absolute(job.output).lexically_normal();
  if (const std::vector<std::string> states = slurm_states(output); !states.empty()) {
    return fail(fmt::format("{} tasks of an earlier submission are in the queue", states.size()), output.string(),
                "wait for them, or end them with scancel");
  }
  const Result<Outlook> outlook = look_ahead(job);
  if (!outlook) return tl::unexpected(outlook.error());
  std::error_code error;
  fs::create_directories(output / "submit", error);
  if (error) return tl::unexpected(write_error("the output folder cannot be created", error.value(), output));
  const Result<void> written = write_file_atomically(output / "job.yaml", resolved_job(job, output));
  if (!written) return tl::unexpected(written.error());
  std::vector<SlurmJob> jobs = slurm_jobs(*outlook, job, options, max_array_size());
  std::string list, after;
  for (SlurmJob& one : jobs) {
    const Result<std::string> id = submit_one(one, output, options, after);
    if (!id) return tl::unexpected(id.error());
    one.id = after = *id;
    list += fmt::format("{} {} {}\n", one.id, one.stage, one.tasks);
    const Result<void> noted = write_file_atomically(jobs_file(output), list);
    if (!noted) return tl::unexpected(noted.error());
  }
  return jobs;
}

std::vector<std::string> slurm_states(const fs::path& output) {
  const std::vector<std::string> ids = submitted_ids(output);
  if (ids.empty()) return {};
  // An id that left the queue long ago is an error for squeue if it is the only one: then nothing is in the queue.
  const Said said =
      said_by({"squeue", "--noheader", "--array", "--format=%T", fmt::format("--jobs={}", fmt::join(ids, ","))});
  std::vector<std::string> states;
  if (said.exit_code != 0) return states;
  std::istringstream lines(said.text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) states.push_back(line);
  }
  return states;
}

}  // namespace isthmus::pipelines
