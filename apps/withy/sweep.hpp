/// \file
/// What the parts of `withy sweep` share.
#pragma once

#include <cstdint>
#include <string>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/campaign/plan.hpp"

namespace withy::app {

struct SweepArguments : CommonArguments {
  std::string plan;
  std::string store;
  bool force = false;       ///< another sweep in the store is replaced
  std::uint64_t index = 0;  ///< of a case
  std::size_t jobs = 0;     ///< threads; 0: one a core
  std::string shard;        ///< "2/8"
  bool slurm = false;
  std::uint64_t tasks = 10;         ///< of the array job
  std::string time;                 ///< limit of a task
  std::vector<std::string> sbatch;  ///< more options of sbatch
  bool dry = false;                 ///< scripts are written and not submitted
};

/// \throws SceneError, InputError, PluginError
campaign::Plan read_plan(const SweepArguments& arguments, Registry& registry);

ExitStatus sweep_case(const SweepArguments& arguments);
ExitStatus sweep_run(const SweepArguments& arguments);
ExitStatus sweep_submit(const SweepArguments& arguments);
ExitStatus sweep_status(const SweepArguments& arguments);
ExitStatus sweep_collect(const SweepArguments& arguments);

}  // namespace withy::app
