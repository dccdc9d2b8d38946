#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/simulation/accuracy.hpp"

namespace withy::app {

using Json = nlohmann::ordered_json;

namespace {

/// How far loops are from closed at a state [m, m/s], and their multipliers there [N].
Json loops_at(const ClosedLoops& loops, std::size_t speeds, const State& state, Work& work) {
  const std::size_t m = loops.closing_equations();
  std::vector<double> gaps(m), rates(m), J(m * speeds), multipliers(m);
  loops.see(state.y, gaps, rates, J, work);
  loops.multipliers(state.time, state.y, multipliers, work);
  return {{"gaps", gaps}, {"gap_rates", rates}, {"multipliers", multipliers}};
}

ExitStatus eval(const StateArguments& arguments) {
  const Engine engine(arguments);
  const EquationsOfMotion& equations = engine.equations();
  const Layout& layout = equations.layout();
  const State state = engine.state(arguments.state);

  const DenseSystem system = equations.system(state.time, state.y);
  const Energies energies = equations.energies(state.y);
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  const Evaluation evaluation = equations.derivatives(state.time, state.y, rates, work);

  Json rows = Json::array();
  for (std::size_t i = 0; i < system.size; ++i) {
    const auto row = system.mass.begin() + static_cast<std::ptrdiff_t>(i * system.size);
    rows.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(system.size)));
  }
  const auto first = rates.begin() + static_cast<std::ptrdiff_t>(layout.positions);
  Json j;
  j["formulation"] = engine.scene().formulation_name;
  j["coordinates"] = layout.speed_names;
  j["mass_matrix"] = std::move(rows);
  j["force"] = system.force;
  j["applied"] = system.applied;
  // Pivots of a singular matrix may be rounding and not zero: then what comes of it is no acceleration.
  constexpr double no_digits = 1e-3;
  const bool lost =
      evaluation.ok() && rounding_error(engine.model(), equations, state, Probing::any).relative > no_digits;
  const bool found = evaluation.ok() && !lost;
  if (found)
    j["accelerations"] = std::vector<double>(first, first + static_cast<std::ptrdiff_t>(layout.speeds));
  else
    j["accelerations"] = nullptr;
  if (found && !engine.model().motions().empty()) {
    std::vector<double> efforts(layout.speeds);
    equations.motion_efforts(state.time, state.y, efforts, work);
    j["motion_efforts"] = efforts;
  }
  if (const auto* loops = dynamic_cast<const ClosedLoops*>(&equations))
    j["constraints"] = loops_at(*loops, layout.speeds, state, work);
  j["kinetic_energy"] = energies.kinetic;
  j["potential_energy"] = energies.potential;
  j["linear_momentum"] = energies.linear_momentum;
  j["angular_momentum"] = energies.angular_momentum;
  j["condition"] = conditioning(system).condition;
  print(j.dump() + '\n');
  if (found) return ExitStatus::done;
  complain(std::string("there are no accelerations at this state: ") +
           (lost                                                  ? "the mass matrix is singular to working accuracy"
            : evaluation.outcome == Evaluation::Outcome::singular ? "the mass matrix cannot be solved"
                                                                  : "they are not finite") +
           (evaluation.body >= 0
                ? " at body '" + engine.model().bodies()[static_cast<std::size_t>(evaluation.body)].name + "'"
                : ""));
  return ExitStatus::stopped;
}

std::function<ExitStatus()> add_eval(CLI::App& c) {
  const auto arguments = std::make_shared<StateArguments>();
  StateArguments& a = *arguments;
  add_scene(c, a);
  add_formulation(c, a);
  add_state(c, a);
  return [arguments] { return eval(*arguments); };
}

}  // namespace

const Command eval_command = {
    "eval", "Evaluate the equations of motion at a state, as JSON",
    "  withy eval scenes/two-link-slew.yaml\n"
    "  withy eval scenes/two-link-slew.yaml --state scenes/states/two-link-bent.json --formulation consistent",
    &add_eval};

}  // namespace withy::app
