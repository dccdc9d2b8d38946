#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/engine.hpp"
#include "withy/core/simulation/moving_state.hpp"
#include "withy/program/allocations.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/timing_json.hpp"

namespace withy::app {
namespace {

struct BenchArguments : StateArguments {
  std::vector<std::string> formulations;  ///< `all` is every one found; empty: the scene's
  bool lanes = false;                     ///< a case in each lane too
  std::size_t threads = 1;                ///< that evaluate branches too; 1: none do
};

using Json = nlohmann::ordered_json;

Json measure(const Engine& engine, const BenchArguments& arguments) {
  // At rest, branches and sines are cheaper than in motion.
  const State given = engine.state(arguments.state);
  const State state = arguments.state.empty() ? moving_state(engine.model(), given) : given;
  const study::EvaluationTimes times = study::time_evaluations(engine.equations(), state, &program::allocations);
  Json result{{"formulation", engine.scene().formulation_name}};
  result.update(times_json(times));
  result["bodies"] = engine.model().bodies().size();
  result["coordinates"] = engine.model().layout().speeds;
  if (arguments.lanes)
    result["lanes"] = lanes_json(study::time_lanes(engine.equations(), state, &program::allocations), times);
  if (arguments.threads > 1)
    result["threads"] = threads_json(study::time_threads(engine.prepared().equations, state, arguments.threads),
                                     engine.model().bodies().size());
  return result;
}

ExitStatus bench(const BenchArguments& arguments) {
  std::vector<std::string> formulations = arguments.formulations;
  if (formulations.empty()) formulations = {""};
  if (formulations == std::vector<std::string>{"all"}) {
    formulations = study::timed_formulations(Plugins(arguments).registry());
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

void add_bench(Options& o, BenchArguments& a) {
  add_scene(o, a);
  o.list("--formulation,--formulations", a.formulations, "ID,ID,...",
         "One formulation, several, or all; default: the scene's");
  add_state(o, a);
  o.flag("--lanes", a.lanes, "Four or eight cases at once too, as `withy sweep run` evaluates them, and the ratio");
  o.value("--threads", a.threads, "N", "On N threads too; from which size that pays").between(1UL, most_threads);
}

}  // namespace

const Command bench_command = {"bench", "Time one evaluation of the equations of motion, as JSON",
                               "  withy bench scenes/two-link-slew.yaml\n"
                               "  withy bench scenes/two-link-slew.yaml --formulation ruthless,quadratic\n"
                               "  withy bench scenes/driven-arm.yaml --lanes",
                               &taking<BenchArguments, add_bench, bench>};

}  // namespace withy::app
