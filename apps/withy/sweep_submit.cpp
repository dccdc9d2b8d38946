#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/sweep.hpp"
#include "withy/campaign/cases.hpp"
#include "withy/campaign/slurm.hpp"
#include "withy/campaign/store.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {

ExitStatus sweep_submit(const SweepArguments& arguments) {
  if (!arguments.slurm) throw InputError("--slurm: missing; it is the one batch system that sweeps are submitted to");
  const Plugins plugins(arguments);
  const campaign::Plan plan = read_plan(arguments, plugins.registry());
  // Made here, so that what is wrong with it is said now.
  const campaign::Store store(arguments.store, plan, arguments.force);
  campaign::SlurmJob job;
  job.program = std::filesystem::read_symlink("/proc/self/exe");
  job.plan = std::filesystem::absolute(arguments.plan);
  job.store = std::filesystem::canonical(arguments.store);
  job.tasks = std::min<std::uint64_t>(arguments.tasks, campaign::Cases(plan).size());
  job.cpus = std::max<std::size_t>(arguments.jobs, 1);
  job.time = arguments.time;
  job.options = arguments.sbatch;
  for (const std::string& folder : arguments.plugin_directories)
    job.arguments.insert(job.arguments.end(), {"--plugins", std::filesystem::absolute(folder).string()});
  const campaign::Submitted submitted = submit(job, arguments.dry);
  nlohmann::ordered_json j = {
      {"tasks", job.tasks}, {"array", submitted.array.string()}, {"collect", submitted.collect.string()}};
  std::string text =
      fmt::format("{} tasks: {} and {}\n", job.tasks, submitted.array.string(), submitted.collect.string());
  if (!arguments.dry) {
    j["array_job"] = submitted.array_job;
    j["collect_job"] = submitted.collect_job;
    text += fmt::format("submitted: array job {}, and {} that collects when it has ended\n", submitted.array_job,
                        submitted.collect_job);
  }
  print(arguments.json ? json_text(j) : text);
  return ExitStatus::done;
}

}  // namespace withy::app
