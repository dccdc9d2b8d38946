#include "withy/campaign/slurm.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "withy/results/output_file.hpp"
#include "withy/results/run_command.hpp"
#include "withy/scene/names.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

std::string directives(const std::vector<std::string>& all) {
  std::string text = "#!/bin/bash\n";
  for (const std::string& one : all) text += "#SBATCH " + one + '\n';
  return text;
}

/// The directive of a log in the store. sbatch takes a line apart at blanks but within quotes, where a backslash goes
/// before what is meant as it is; in names of files % begins what Slurm puts in.
std::string log_directive(const SlurmJob& job, const char* name) {
  std::string text = "--output=\"";
  for (const char c : job.store.string()) {
    if (c == '"') text += '\\';
    text += c;
    if (c == '%') text += c;
  }
  return text + "/slurm/" + name + '"';
}

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

std::string array_script(const SlurmJob& job) {
  std::vector<std::string> all = {"--job-name=withy-sweep",
                                  fmt::format("--array=1-{}", job.tasks),
                                  fmt::format("--cpus-per-task={}", job.cpus),
                                  "--requeue",
                                  "--open-mode=append",
                                  log_directive(job, "%a.log"),
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
  std::vector<std::string> all = {"--job-name=withy-collect", log_directive(job, "collect.log")};
  all.insert(all.end(), job.options.begin(), job.options.end());
  return directives(all) +
         fmt::format("\nexec {} sweep collect {}\n", quoted(job.program.string()), quoted(job.store.string()));
}

Submitted submit(const SlurmJob& job, bool dry) {
  // In a name with a backslash Slurm puts nothing in and leaves the backslash out; a directive is one line.
  if (job.store.string().find_first_of("\\\n") != std::string::npos)
    throw study::InputError(in_quotes(job.store.string()) +
                            " has a backslash or an end of a line in its name, with which Slurm writes no log; need "
                            "another folder");
  const std::filesystem::path folder = job.store / "slurm";
  std::filesystem::create_directories(folder);
  Submitted submitted{folder / "array.sh", folder / "collect.sh", {}, {}};
  write_file(submitted.array, array_script(job));
  write_file(submitted.collect, collect_script(job));
  if (dry) return submitted;
  submitted.array_job = output_of("sbatch --parsable " + quoted(submitted.array.string()));
  const std::string number = submitted.array_job.substr(0, submitted.array_job.find(';'));
  submitted.collect_job = output_of(
      fmt::format("sbatch --parsable --dependency=afterany:{} {}", number, quoted(submitted.collect.string())));
  return submitted;
}

}  // namespace withy::campaign
