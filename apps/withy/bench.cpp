#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/allocations.hpp"
#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/simulation/moving_state.hpp"
#include "withy/results/json_text.hpp"
#include "withy/study/timing.hpp"

namespace withy::app {
namespace {

struct BenchArguments : StateArguments {
  std::vector<std::string> formulations;  ///< `all` is every one found; empty: the scene's
  bool lanes = false;                     ///< four cases at once too
};

using Json = nlohmann::ordered_json;

/// What four cases at once cost beside one at a time, `one`; or why there is no such thing.
Json measure_lanes(const EquationsOfMotion& equations, const State& state, const study::EvaluationTimes& one) {
  const auto [refusal, times] = study::time_lanes(equations, state, &allocations);
  Json result{{"evaluations_per_second", 1 / one.median}};
  if (!refusal.empty()) {
    result["one_at_a_time_because"] = refusal;
    return result;
  }
  result.update({{"evaluations_per_second_in_lanes", 1 / times.median},
                 {"ratio", one.median / times.median},
                 {"ns_per_evaluation", 1e9 * times.median},
                 {"ns_fastest_batch", 1e9 * times.fastest},
                 {"ns_slowest_batch", 1e9 * times.slowest},
                 {"evaluations", times.evaluations},
                 {"allocations_per_evaluation", times.allocations}});
  return result;
}

Json measure(const Engine& engine, const BenchArguments& arguments) {
  // At rest, branches and sines are cheaper than in motion.
  const State given = engine.state(arguments.state);
  const State state = arguments.state.empty() ? moving_state(engine.model(), given) : given;
  const study::EvaluationTimes times = study::time_evaluations(engine.equations(), state, &allocations);
  Json result{{"formulation", engine.scene().formulation_name},
              {"ns_per_evaluation", 1e9 * times.median},
              {"ns_fastest_batch", 1e9 * times.fastest},
              {"ns_slowest_batch", 1e9 * times.slowest},
              {"evaluations", times.evaluations},
              {"allocations_per_evaluation", times.allocations},
              {"bodies", engine.model().bodies().size()},
              {"coordinates", engine.model().layout().speeds}};
  if (arguments.lanes) result["lanes"] = measure_lanes(engine.equations(), state, times);
  return result;
}

/// Those that a name is enough for, but `auto`: its equations are others', chosen along a run.
std::vector<std::string> all_formulations(Registry& registry) {
  std::vector<std::string> ids = registry.ids<Formulation>();
  std::erase_if(ids, [&](const std::string& id) {
    const std::vector<ParameterSpec>& options = registry.find<Formulation>(id)->parameters;
    return id == "auto" || std::any_of(options.begin(), options.end(), [](const auto& o) { return o.required; });
  });
  return ids;
}

ExitStatus bench(const BenchArguments& arguments) {
  std::vector<std::string> formulations = arguments.formulations;
  if (formulations.empty()) formulations = {""};
  if (formulations == std::vector<std::string>{"all"}) {
    formulations = all_formulations(Plugins(arguments).registry());
  }
  std::vector<Json> results;
  SceneArguments one = arguments;
  const study::Control control = study_control("bench");
  for (const std::string& formulation : formulations) {
    if (control.stop()) return ExitStatus::interrupted;
    control.tell(static_cast<double>(results.size()), static_cast<double>(formulations.size()));
    one.options.formulation = formulation;
    const Engine engine(one);
    Json result{{"scene", engine.scene().file}};
    result.update(measure(engine, arguments));
    results.push_back(std::move(result));
  }
  print(json_text(results.size() == 1 ? results.front() : Json(results)));
  return ExitStatus::done;
}

std::function<ExitStatus()> add_bench(CLI::App& c) {
  const auto arguments = std::make_shared<BenchArguments>();
  BenchArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.formulations, "--formulation,--formulations",
                   "One formulation, several, or all; default: the scene's");
  add_state(c, a);
  c.add_flag("--lanes", a.lanes, "Four cases at once too, as `withy sweep run` evaluates them, and the ratio");
  return [arguments] { return bench(*arguments); };
}

}  // namespace

const Command bench_command = {"bench", "Time one evaluation of the equations of motion, as JSON",
                               "  withy bench scenes/two-link-slew.yaml\n"
                               "  withy bench scenes/two-link-slew.yaml --formulation ruthless,quadratic\n"
                               "  withy bench scenes/driven-arm.yaml --lanes",
                               &add_bench};

}  // namespace withy::app
