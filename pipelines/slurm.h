// A survey as job arrays of Slurm: every task is a shard of the job, everything passes through the store.
//
//   look, scans (array) -> pairs (array), as many rounds as wanted -> solve (one job, whole run)
//
// each after the one before has ended, whatever became of it: what a lost task left out, the solving run makes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipelines/job.h"
#include "pipelines/outlook.h"

namespace isthmus::pipelines {

struct SlurmOptions {
  std::string program;            ///< path of isthmus as the nodes see it
  std::string partition;          ///< empty: the cluster's default
  int cpus = 1;                   ///< of a task
  int most_tasks = 100;           ///< of an array; the cluster's own limit (MaxArraySize) counts as well
  double task_minutes = 10;       ///< short items are packed until a task takes about so long
  int pair_rounds = 2;            ///< arrays of pairs: the first round and later ones
  std::vector<std::string> more;  ///< further arguments of sbatch
};

struct SlurmJob {
  std::string id;
  std::string stage;  ///< "scans", "pairs", "solve"
  std::size_t tasks = 1;
};

/// The arrays that `outlook` calls for: no stage of which everything is in the store.
std::vector<SlurmJob> slurm_jobs(const Outlook& outlook, const Job& job, const SlurmOptions& options,
                                 std::size_t max_array_size);

/// The batch script of one stage.
std::string slurm_script(const SlurmJob& job, const std::filesystem::path& output, const SlurmOptions& options);

/// Writes OUT/job.yaml, OUT/submit/*.sh and OUT/submit/jobs.txt and submits. Fails without Slurm, or while jobs of an
/// earlier submission of this output are in the queue.
Result<std::vector<SlurmJob>> submit_to_slurm(const Job& job, const SlurmOptions& options);

/// States of the tasks of an output's last submission that are still in the queue ("RUNNING", "PENDING"), one each;
/// empty if there is no submission or no Slurm.
std::vector<std::string> slurm_states(const std::filesystem::path& output);

}  // namespace isthmus::pipelines
