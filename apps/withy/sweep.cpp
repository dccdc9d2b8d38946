#include "withy/apps/withy/sweep.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/case_text.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

ExitStatus status_of(const campaign::CaseResult& result) {
  if (result.completed()) return ExitStatus::done;
  if (result.status == name(RunStatus::interrupted)) return ExitStatus::interrupted;
  return result.status == "refused" ? ExitStatus::bad_input : ExitStatus::stopped;
}

}  // namespace

campaign::Plan read_plan(const SweepArguments& arguments, Registry& registry) {
  try {
    return campaign::read_plan(arguments.plan, registry, arguments.plugin_directories);
  } catch (const std::system_error& e) {
    throw InputError(e.what());
  }
}

ExitStatus sweep_case(const SweepArguments& arguments) {
  const Plugins plugins(arguments);
  const campaign::Plan plan = read_plan(arguments, plugins.registry());
  const campaign::Cases cases(plan);
  if (arguments.index >= cases.size())
    throw InputError(fmt::format("{}: got case {}; need 0 to {}", arguments.plan, arguments.index, cases.size() - 1));
  const auto result = run_case(plan, cases, arguments.index, plugins.registry(), run_control("case"));
  const auto j = case_json(plan, result);
  print(arguments.json ? json_text(j) : campaign::case_text(j));
  if (!result.completed()) complain(result.status + ": " + result.message);
  return status_of(result);
}

namespace {

void add_plan(Options& o, SweepArguments& a) {
  o.argument("PLAN", a.plan, "Plan of the sweep (YAML or JSON)").required().checked(campaign::is_no_plan);
}

void add_case(Options& o, SweepArguments& a) {
  add_plan(o, a);
  o.argument("CASE", a.index, "Number of the case, from 0").required();
  add_common(o, a);
}

void add_run_part(Options& o, SweepArguments& a) {
  add_plan(o, a);
  o.value("--out,--store", a.store, "STORE",
          "Folder that keeps the results; the same command goes on with what is there")
      .required();
  o.value("--jobs", a.jobs, "N", "Cases run at once; default: one a core");
  o.value("--shard", a.shard, "I/N", "The I-th of N parts of the cases alone, for as many processes or machines");
  o.flag("--force", a.force, "Replace another sweep that the folder holds");
  add_common(o, a);
}

void add_submit(Options& o, SweepArguments& a) {
  add_plan(o, a);
  o.value("--out,--store", a.store, "STORE", "Folder that keeps the results, on a file system that all nodes share")
      .required();
  o.flag("--slurm", a.slurm, "As an array job of Slurm, and a job that collects after it");
  o.value("--tasks", a.tasks, "N", "Tasks of the array")
      .between(std::uint64_t{1}, std::uint64_t{100000})
      .with_default();
  o.value("--jobs", a.jobs, "N", "Cases that a task runs at once, and its CPUs; default: 1");
  o.value("--time", a.time, "TIME", "Time limit of a task, as sbatch has it; a task that needs more is queued again");
  o.repeated("--sbatch", a.sbatch, "OPTION", "One more option of sbatch, as --sbatch=--partition=short; repeatable");
  o.flag("--dry-run", a.dry, "Write the scripts, submit nothing");
  o.flag("--force", a.force, "Replace another sweep that the folder holds");
  add_common(o, a);
}

void add_store(Options& o, SweepArguments& a) {
  o.value("STORE,--out,--store", a.store, "STORE", "Folder of the results, by its place or by name").required();
  add_common(o, a);
}

template <void (*tell)(Options&, SweepArguments&), ExitStatus (*call)(const SweepArguments&)>
constexpr auto part = &taking<SweepArguments, tell, call>;

const Command run_part = {"run", "Run the cases that the store lacks",
                          "  withy sweep run scenes/sweeps/slew-tolerances.yaml --out results/tolerances",
                          part<add_run_part, sweep_run>};
const Command submit_part = {
    "submit", "Have a cluster run the cases",
    "  withy sweep submit scenes/sweeps/slew-tolerances.yaml --out results/cluster --slurm --tasks 20 --time 01:00:00",
    part<add_submit, sweep_submit>};
const Command status_part = {"status", "Show how many cases are done, failed and missing, and how long the rest takes",
                             "  withy sweep status results/tolerances", part<add_store, sweep_status>};
const Command collect_part = {"collect",
                              "Make tables of the finished cases: values, statistics, sensitivities, failures",
                              "  withy sweep collect results/tolerances", part<add_store, sweep_collect>};
const Command case_part = {"case", "Run one case alone, with the same bits as in the sweep",
                           "  withy sweep case scenes/sweeps/slew-tolerances.yaml 17", part<add_case, sweep_case>};

program::Call add_sweep(Options& o) {
  return o.parts(std::array{&run_part, &submit_part, &status_part, &collect_part, &case_part});
}

}  // namespace

const Command sweep_command = {"sweep", "Run many cases of a scene, by a plan",
                               "  withy sweep run scenes/sweeps/slew-tolerances.yaml --out results/tolerances\n"
                               "  withy sweep status results/tolerances\n"
                               "  withy sweep collect results/tolerances\n"
                               "  withy sweep case scenes/sweeps/slew-tolerances.yaml 17",
                               &add_sweep};

}  // namespace withy::app
