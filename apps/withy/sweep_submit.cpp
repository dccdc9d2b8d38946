#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/sweep.hpp"
#include "withy/campaign/cases.hpp"
#include "withy/campaign/slurm.hpp"
#include "withy/campaign/store.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

/// What a command prints. \throws std::runtime_error where it fails
std::string output_of(const std::string& command) {
  const auto close = [](std::FILE* pipe) { return ::pclose(pipe); };
  std::unique_ptr<std::FILE, decltype(close)> pipe(::popen(command.c_str(), "r"), close);
  if (pipe == nullptr) throw std::system_error(errno, std::generic_category(), command);
  std::string text;
  std::array<char, 256> part;
  while (std::fgets(part.data(), part.size(), pipe.get()) != nullptr) text += part.data();
  if (::pclose(pipe.release()) != 0) throw std::runtime_error("it failed: " + command);
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace

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
  std::filesystem::create_directories(job.store / "slurm");
  const std::filesystem::path array = job.store / "slurm/array.sh", collect = job.store / "slurm/collect.sh";
  write_file(array, array_script(job));
  write_file(collect, collect_script(job));
  nlohmann::ordered_json j = {{"tasks", job.tasks}, {"array", array.string()}, {"collect", collect.string()}};
  std::string text = fmt::format("{} tasks: {} and {}\n", job.tasks, array.string(), collect.string());
  if (!arguments.dry) {
    const std::string id = output_of("sbatch --parsable " + campaign::quoted(array.string()));
    const std::string collects = output_of(fmt::format("sbatch --parsable --dependency=afterany:{} {}",
                                                       id.substr(0, id.find(';')), campaign::quoted(collect.string())));
    j["array_job"] = id;
    j["collect_job"] = collects;
    text += fmt::format("submitted: array job {}, and {} that collects when it has ended\n", id, collects);
  }
  print(arguments.json ? json_text(j) : text);
  return ExitStatus::done;
}

}  // namespace withy::app
