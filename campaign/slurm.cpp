#include "withy/campaign/slurm.hpp"

#include <fmt/format.h>

namespace withy::campaign {
namespace {

std::string directives(const std::vector<std::string>& all) {
  std::string text = "#!/bin/bash\n";
  for (const std::string& one : all) text += "#SBATCH " + one + '\n';
  return text;
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + '\'';
}

std::string array_script(const SlurmJob& job) {
  std::vector<std::string> all = {"--job-name=withy-sweep",
                                  fmt::format("--array=1-{}", job.tasks),
                                  fmt::format("--cpus-per-task={}", job.cpus),
                                  "--requeue",
                                  "--open-mode=append",
                                  fmt::format("--output={}/slurm/%a.log", job.store.string()),
                                  fmt::format("--signal=B:USR1@{}", job.warning)};
  if (!job.time.empty()) all.push_back("--time=" + job.time);
  all.insert(all.end(), job.options.begin(), job.options.end());
  std::string run = fmt::format("{} sweep run {} --out {} --jobs {}", quoted(job.program.string()),
                                quoted(job.plan.string()), quoted(job.store.string()), job.cpus);
  for (const std::string& argument : job.arguments) run += ' ' + quoted(argument);
  return directives(all) + fmt::format(R"(
# Slurm sends USR1 {0} s before the task's time is over.
out_of_time=no
sweep=
trap 'out_of_time=yes; [ -z "$sweep" ] || kill -TERM "$sweep"' USR1
{1} --shard "$SLURM_ARRAY_TASK_ID/{2}" &
sweep=$!
wait "$sweep"
status=$?
while kill -0 "$sweep" 2>/dev/null; do  # the signal ended the waiting, not the sweep
  wait "$sweep"
  status=$?
done
if [ "$out_of_time" = yes ] && {{ [ "$status" = 130 ] || [ "$status" = 143 ]; }}; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
  exit 0
fi
exit "$status"
)",
                                       job.warning, run, job.tasks);
}

std::string collect_script(const SlurmJob& job) {
  std::vector<std::string> all = {"--job-name=withy-collect",
                                  fmt::format("--output={}/slurm/collect.log", job.store.string())};
  all.insert(all.end(), job.options.begin(), job.options.end());
  return directives(all) +
         fmt::format("\nexec {} sweep collect {}\n", quoted(job.program.string()), quoted(job.store.string()));
}

}  // namespace withy::campaign
