#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "withy/apps/withy/sweep.hpp"
#include "withy/campaign/sweep_page.hpp"
#include "withy/campaign/sweep_text.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

campaign::Collected collected_with_page(const std::string& store) {
  const campaign::Collected collected = campaign::collect(store);
  campaign::write_sweep_page(store, collected);
  return collected;
}

}  // namespace

ExitStatus sweep_run(const SweepArguments& arguments) {
  const Plugins plugins(arguments);
  campaign::SweepSettings settings;
  settings.jobs = arguments.jobs;
  campaign::read_shard(arguments.shard, settings);
  const campaign::Plan plan = read_plan(arguments, plugins.registry());
  const campaign::Store store(arguments.store, plan, arguments.force);
  settings.control = study_control("sweep");
  const campaign::SweepOutcome outcome = run_sweep(plan, plugins.registry(), store, settings);
  if (outcome.lost > 0) complain(campaign::lost_text(outcome.lost));
  std::string text = outcome_text(outcome, settings);
  nlohmann::ordered_json j = outcome_json(outcome, arguments.store);
  if (outcome.whole() && settings.shards == 1) {
    const campaign::Collected collected = collected_with_page(arguments.store);
    text += collected_text(collected, arguments.store);
    j["collected"] = collected_json(collected);
  }
  print(arguments.json ? json_text(j) : text);
  if (outcome.whole()) return ExitStatus::done;
  const bool failed = plan.stop_on_failure && outcome.failure;
  complain(failed ? fmt::format("stopped, as the plan says, at case {}", outcome.failure->index)
                  : "interrupted; the same command goes on from there");
  return failed ? ExitStatus::stopped : ExitStatus::interrupted;
}

ExitStatus sweep_status(const SweepArguments& arguments) {
  const campaign::StoreDescription about = campaign::read_description(arguments.store);
  const campaign::StoreIndex index(arguments.store, about);
  print(arguments.json ? json_text(status_json(about, index)) : status_text(about, index));
  return ExitStatus::done;
}

ExitStatus sweep_collect(const SweepArguments& arguments) {
  const campaign::Collected collected = collected_with_page(arguments.store);
  print(arguments.json ? json_text(collected_json(collected)) : collected_text(collected, arguments.store));
  return ExitStatus::done;
}

}  // namespace withy::app
