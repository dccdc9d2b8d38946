#include <nlohmann/json.hpp>

#include "withy/apps/withy/engine.hpp"
#include "withy/results/evaluation.hpp"

namespace withy::app {
namespace {

ExitStatus eval(const StateArguments& arguments) {
  const Engine engine(arguments);
  const Evaluated evaluated = evaluate(engine.prepared(), engine.state(arguments.state));
  print(evaluated.json.dump() + '\n');
  if (evaluated.problem.empty()) return ExitStatus::done;
  complain("there are no accelerations at this state: " + evaluated.problem);
  return ExitStatus::stopped;
}

void add_eval(Options& o, StateArguments& a) {
  add_scene(o, a);
  add_formulation(o, a);
  add_state(o, a);
}

}  // namespace

const Command eval_command = {
    "eval", "Evaluate the equations of motion at a state, as JSON",
    "  withy eval scenes/two-link-slew.yaml\n"
    "  withy eval scenes/two-link-slew.yaml --state scenes/states/two-link-bent.json --formulation consistent",
    &taking<StateArguments, add_eval, eval>};

}  // namespace withy::app
