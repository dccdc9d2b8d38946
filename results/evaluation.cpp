#include "withy/results/evaluation.hpp"

#include "withy/core/model/event_plan.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/core/simulation/instants.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// How far loops are from closed at a state [m, m/s], and their multipliers there [N].
Json loops_at(const ClosedLoops& loops, std::size_t speeds, const State& state, Work& work) {
  const std::size_t m = loops.closing_equations();
  std::vector<double> gaps(m), rates(m), J(m * speeds), multipliers(m);
  loops.see(state.y, gaps, rates, J, work);
  loops.multipliers(state.time, state.y, multipliers, work);
  return {{"gaps", gaps}, {"gap_rates", rates}, {"multipliers", multipliers}};
}

Json rows_of(const DenseSystem& system) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < system.size; ++i) {
    const auto row = system.mass.begin() + static_cast<std::ptrdiff_t>(i * system.size);
    rows.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(system.size)));
  }
  return rows;
}

std::string no_accelerations(const Model& model, const Evaluation& evaluation, bool lost) {
  const std::string why = lost ? "the mass matrix is singular to working accuracy"
                          : evaluation.outcome == Evaluation::Outcome::singular ? "the mass matrix cannot be solved"
                                                                                : "they are not finite";
  if (evaluation.body < 0) return why;
  return why + " at body '" + model.bodies()[static_cast<std::size_t>(evaluation.body)].name + "'";
}

}  // namespace

Evaluated evaluate(const study::Prepared& prepared, const State& given) {
  const EquationsOfMotion& equations = *prepared.equations;
  const Model& model = prepared.model();
  const State state = begun(model, equations, given);
  const Layout& layout = equations.layout();
  const DenseSystem system = equations.system(state.time, state.y);
  const Energies energies = equations.energies(state.y);
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  const Evaluation evaluation = equations.derivatives(state.time, state.y, rates, work);
  // Pivots of a singular matrix may be rounding and not zero: then what comes of it is no acceleration.
  constexpr double no_digits = 1e-3;
  const bool lost = evaluation.ok() && rounding_error(model, equations, state, Probing::any).relative > no_digits;
  const bool found = evaluation.ok() && !lost;

  Json j;
  j["formulation"] = prepared.scene.formulation_name;
  j["coordinates"] = layout.speed_names;
  j["mass_matrix"] = rows_of(system);
  j["force"] = system.force;
  j["applied"] = system.applied;
  j["accelerations"] = nullptr;
  const auto first = rates.begin() + static_cast<std::ptrdiff_t>(layout.positions);
  if (found) j["accelerations"] = std::vector<double>(first, first + static_cast<std::ptrdiff_t>(layout.speeds));
  if (found && (!model.motions().empty() || !locked_hinges(model, state).empty())) {
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
  return {std::move(j), found ? std::string() : no_accelerations(model, evaluation, lost)};
}

}  // namespace withy
