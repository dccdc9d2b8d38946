/// \file
/// Sweeps as array jobs of Slurm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace withy::campaign {

struct SlurmJob {
  std::filesystem::path program, plan, store;  ///< absolute
  std::uint64_t tasks = 1;                     ///< of the array; each runs a shard
  std::size_t cpus = 1;                        ///< of a task: its jobs
  std::string time;                            ///< limit of a task, as sbatch has it; empty: the partition's
  unsigned warning = 60;               ///< time before that at which a task ends its cases and asks to go on [s]
  std::vector<std::string> options;    ///< more of sbatch's, as "--partition=short"
  std::vector<std::string> arguments;  ///< more of `withy sweep run`'s
};

/// The batch script of the array. A task whose time runs out ends its cases, keeps what is done and is queued again; so
/// is one whose node is lost or that is preempted. One that is cancelled is not.
std::string array_script(const SlurmJob& job);
/// The batch script that makes the tables when all tasks have ended.
std::string collect_script(const SlurmJob& job);

/// The scripts in the store, and the numbers of their jobs.
struct Submitted {
  std::filesystem::path array, collect;
  std::string array_job, collect_job;  ///< as sbatch says them; empty where nothing was submitted
};
/// Writes the scripts into the store's folder `slurm` and has sbatch queue them. \param dry only writes them
/// \throws study::InputError where Slurm cannot write logs into that folder; std::runtime_error where sbatch fails;
/// std::system_error
Submitted submit(const SlurmJob& job, bool dry);

}  // namespace withy::campaign
