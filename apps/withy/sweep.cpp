#include "withy/apps/withy/sweep.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/output.hpp"
#include "withy/campaign/case_lanes.hpp"
#include "withy/campaign/derived.hpp"
#include "withy/campaign/kept.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/point.hpp"

namespace withy::app {
namespace {

ExitStatus status_of(const campaign::CaseResult& result) {
  if (result.completed()) return ExitStatus::done;
  if (result.status == name(RunStatus::interrupted)) return ExitStatus::interrupted;
  return result.status == "refused" ? ExitStatus::bad_input : ExitStatus::stopped;
}

/// The run of the case by itself, with all its results.
std::string run_command_of(const campaign::Plan& plan, const SceneValues& scene, const std::vector<Value>& values) {
  std::string text = "withy run " + scene.file();
  const auto add = [&](const std::string& path, const Value& value) {
    text += " --set '" + study::Change{path, value}.text() + '\'';
  };
  for (const auto& [path, value] : plan.set) add(path, value);
  const std::vector<std::string> paths = varied_paths(plan);
  for (std::size_t a = 0; a < values.size(); ++a)
    if (values[a].kind() != Value::Kind::null) add(paths[a], values[a]);
  return text;
}

std::string case_text(const nlohmann::ordered_json& j) {
  TextTable table({"<", ""});
  for (const char* part : {"values", "results"})
    for (const auto& [name, value] : j.at(part).items()) table.add({name, plain_text(value)});
  return fmt::format("case {}: {}\n\n{}\nThe same run with all its results:\n  {}\n", j.at("case").dump(),
                     j.at("status").get<std::string>(), table.str(), j.at("command").get<std::string>());
}

}  // namespace

campaign::Plan read_plan(const SweepArguments& arguments, Registry& registry) {
  try {
    return campaign::read_plan(arguments.plan, registry);
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
  const std::vector<Value>& values = result.values;
  const std::vector<std::string> paths = varied_paths(plan);
  nlohmann::ordered_json j = {{"case", result.index},
                              {"status", result.status},
                              {"message", result.message},
                              {"values", nlohmann::ordered_json::object()},
                              {"results", nlohmann::ordered_json::object()}};
  for (std::size_t a = 0; a < values.size(); ++a) j["values"][paths[a]] = value_json(values[a]);
  const std::vector<std::string> columns = kept_columns(plan);
  for (std::size_t i = 0; i < result.numbers.size(); ++i) j["results"][columns[i]] = result.numbers[i];
  j["command"] = run_command_of(plan, plan.base->values, values);
  print(arguments.json ? json_text(j) : case_text(j));
  if (!result.completed()) complain(result.status + ": " + result.message);
  return status_of(result);
}

namespace {

void add_plan(CLI::App& part, SweepArguments& a) {
  part.add_option("PLAN", a.plan, "Plan of the sweep (YAML or JSON)")->required();
}

void add_case(CLI::App& part, SweepArguments& a) {
  add_plan(part, a);
  part.add_option("CASE", a.index, "Number of the case, from 0")->required();
}

void add_run_part(CLI::App& part, SweepArguments& a) {
  add_plan(part, a);
  part.add_option("--out,--store", a.store,
                  "Folder that keeps the results; the same command goes on with what is there")
      ->type_name("STORE")
      ->required();
  part.add_option("--jobs", a.jobs, "Cases run at once; default: one a core")->type_name("N");
  part.add_option("--shard", a.shard, "The I-th of N parts of the cases alone, for as many processes or machines")
      ->type_name("I/N");
  part.add_flag("--force", a.force, "Replace another sweep that the folder holds");
}

void add_submit(CLI::App& part, SweepArguments& a) {
  add_plan(part, a);
  part.add_option("--out,--store", a.store, "Folder that keeps the results, on a file system that all nodes share")
      ->type_name("STORE")
      ->required();
  part.add_flag("--slurm", a.slurm, "As an array job of Slurm, and a job that collects after it");
  part.add_option("--tasks", a.tasks, "Tasks of the array")
      ->type_name("N")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{100000}))
      ->capture_default_str();
  part.add_option("--jobs", a.jobs, "Cases that a task runs at once, and its CPUs; default: 1")->type_name("N");
  part.add_option("--time", a.time, "Time limit of a task, as sbatch has it; a task that needs more is queued again")
      ->type_name("TIME");
  part.add_option("--sbatch", a.sbatch, "One more option of sbatch, as --sbatch=--partition=short; repeatable")
      ->type_name("OPTION")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  part.add_flag("--dry-run", a.dry, "Write the scripts, submit nothing");
  part.add_flag("--force", a.force, "Replace another sweep that the folder holds");
}

void add_store(CLI::App& part, SweepArguments& a) {
  part.add_option("STORE,--out,--store", a.store, "Folder of the results")->type_name("STORE")->required();
}

/// A command of the command: what it does, what it takes, an example.
struct Part {
  const char *name, *meaning, *example;
  void (*add)(CLI::App&, SweepArguments&);
  ExitStatus (*call)(const SweepArguments&);
};
const Part parts[] = {
    {"run", "Run the cases that the store lacks",
     "  withy sweep run scenes/sweeps/slew-tolerances.yaml --out results/tolerances", &add_run_part, &sweep_run},
    {"submit", "Have a cluster run the cases",
     "  withy sweep submit scenes/sweeps/slew-tolerances.yaml --out results/cluster --slurm --tasks 20 --time 01:00:00",
     &add_submit, &sweep_submit},
    {"status", "Say what is done, has failed and is missing, and how long that takes",
     "  withy sweep status results/tolerances", &add_store, &sweep_status},
    {"collect", "Make tables of what is done: cases, statistics, sensitivities, failures",
     "  withy sweep collect results/tolerances", &add_store, &sweep_collect},
    {"case", "Run one case alone, to the same bits as among the others",
     "  withy sweep case scenes/sweeps/slew-tolerances.yaml 17", &add_case, &sweep_case}};

std::function<ExitStatus()> add_sweep(CLI::App& c) {
  const auto arguments = std::make_shared<SweepArguments>();
  const auto call = std::make_shared<std::function<ExitStatus()>>();
  c.require_subcommand(1);
  for (const Part& part : parts) {
    CLI::App& own = *c.add_subcommand(part.name, part.meaning);
    own.footer(std::string("Examples:\n") + part.example);
    part.add(own, *arguments);
    add_common(own, *arguments);
    own.callback([call, arguments, &part] { *call = [arguments, &part] { return part.call(*arguments); }; });
  }
  return [call] { return (*call)(); };
}

}  // namespace

const Command sweep_command = {"sweep", "Run many cases of a scene, as a plan says",
                               "  withy sweep run scenes/sweeps/slew-tolerances.yaml --out results/tolerances\n"
                               "  withy sweep status results/tolerances\n"
                               "  withy sweep collect results/tolerances\n"
                               "  withy sweep case scenes/sweeps/slew-tolerances.yaml 17",
                               &add_sweep};

}  // namespace withy::app
