#include "withy/study/linear_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/analysis/steady_state.hpp"
#include "withy/core/analysis/turn.hpp"
#include "withy/core/model/switched_load.hpp"
#include "withy/core/plugin/changing_law.hpp"
#include "withy/study/linear_inputs.hpp"
#include "withy/study/linear_outputs.hpp"
#include "withy/study/linear_parts.hpp"
#include "withy/study/sampled_steady.hpp"
#include "withy/study/timed_loads.hpp"
#include "withy/study/turning.hpp"

namespace withy::study {
namespace {

/// Whether no mode moves; hinges may turn steadily.
bool at_rest(const Configuration& c) {
  for (const Slot& slot : c.layout().bodies) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      if (c.state().y[c.layout().positions + slot.speed + i] != 0) return false;
    }
  }
  return true;
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += fmt::format("{}'{}'", text.empty() ? "" : ", ", name);
  return text;
}

/// Loads that act and whose gain is that of an instant.
std::vector<std::string> changing_loads(const Configuration& c) {
  std::vector<std::string> names;
  const std::vector<LoadNode>& loads = c.prepared().model().loads();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const BoundLoad* load = loads[i].load.get();
    if (const auto* forms = dynamic_cast<const LoadOfForms*>(load)) {
      for (const LoadSlot& slot : c.layout().discrete_slots)
        if (slot.load == i) load = forms->acting(std::span(c.state().y).subspan(slot.first, slot.count));
    }
    const auto* law = dynamic_cast<const ChangingLaw*>(load);
    if (law != nullptr && law->changes_gain()) names.push_back(loads[i].name);
  }
  return names;
}

/// Loads by which time changes A. What goes in is as the state has it, whatever a run is given later.
std::vector<std::string> shaking_loads(const Configuration& c, const Turning& turning) {
  std::vector<std::string> names = timed_loads(c, c.state(), turning).shaking;
  for (const LoadNode& node : c.prepared().model().loads())
    if (node.load->input() != nullptr) names.erase(std::remove(names.begin(), names.end(), node.name), names.end());
  return names;
}

/// C, D of the outputs in continuous time, and by what is held (columns after those of the states).
void look(SmallMotions& motions, const SampledLoads& sampled, const std::vector<LinearInput>& inputs,
          const std::vector<LinearOutput>& outputs, LinearModel& linear) {
  const Eigen::Index n = motions.size(), rows = static_cast<Eigen::Index>(outputs.size());
  LinearSystem& s = linear.system;
  s.C.setZero(rows, n + sampled.size());
  s.D.setZero(rows, static_cast<Eigen::Index>(inputs.size()));
  const bool sensors = std::any_of(outputs.begin(), outputs.end(), [](const LinearOutput& o) { return o.sensed >= 0; });
  SensedDerivatives seen;
  Eigen::MatrixXd by_held, by_input;
  if (sensors) {
    seen = sensed_derivatives(motions);
    by_held.resize(seen.values.size(), sampled.size());
    by_input.resize(seen.values.size(), s.D.cols());
    for (Eigen::Index i = 0; i < sampled.size(); ++i) {
      const auto held_at = [&](double h) { return sampled.displaced(h * Eigen::VectorXd::Unit(sampled.size(), i)); };
      by_held.col(i) = sensed_slope(motions, held_at, motions.step(sampled.efforts().col(i)));
    }
    for (std::size_t k = 0; k < inputs.size(); ++k)
      by_input.col(static_cast<Eigen::Index>(k)) =
          sensed_slope(motions, inputs[k].state_at, motions.step(inputs[k].efforts));
  }
  for (Eigen::Index k = 0; k < rows; ++k) {
    const LinearOutput& o = outputs[static_cast<std::size_t>(k)];
    linear.outputs.push_back(o.column);
    linear.output_values.push_back(o.sensed >= 0 ? seen.values[o.sensed] : o.value);
    if (o.sensed < 0) {
      const Eigen::RowVectorXd row = row_of_free(o, motions.free());
      s.C.row(k).head(row.size()) = row;
      continue;
    }
    s.C.row(k) << seen.by_state.row(o.sensed), by_held.row(o.sensed);
    s.D.row(k) = by_input.row(o.sensed);
  }
  linear.output_derivatives =
      sensors ? fmt::format("exact but for sensors, by central differences of eighth order, to {:.1g}",
                            std::max(1e-15, seen.uncertainty))
              : "exact";
}

}  // namespace

LinearModel about(const Configuration& c, const SmallMotions& motions, const SampledLoads& sampled) {
  LinearModel linear;
  linear.states = motions.names();
  linear.states.insert(linear.states.end(), sampled.names().begin(), sampled.names().end());
  linear.derivatives = motions.derivatives();
  for (const Eigen::Index s : motions.free())
    linear.accelerations.emplace_back(c.layout().speed_names[static_cast<std::size_t>(s)], motions.accelerations()[s]);
  linear.changing = changing_loads(c);
  const TurnCheck turn = check_turn(c.dynamics(), c.state(), c.held());
  if (!turn.periodic()) linear.shaking = shaking_loads(c, turn.turning);
  linear.frozen = turn.periodic() || !linear.shaking.empty();
  linear.equilibrium = at_rest(c) && is_steady(c) && uneven_motions(c.dynamics(), c.state(), c.held()).empty();
  return linear;
}

void sample(const SampledLoads& sampled, const SampledLoads::Held& held, LinearModel& linear) {
  LinearSystem& system = linear.system;
  if (sampled.none()) {
    system.A = held.A, system.B = held.B;
    return;
  }
  auto [Phi, Gamma] = sampled.map(held);
  system.A = std::move(Phi), system.B = std::move(Gamma);
  system.C = system.C * sampled.renewal(held);
  system.period = sampled.period();
  if (held.felt.empty()) return;
  for (const Column& input : linear.inputs) linear.states.push_back(input.name + ".before");
}

std::string note_of_frozen(const LinearModel& linear) {
  if (!linear.frozen) return {};
  return linear.shaking.empty()
             ? "the equations change as hinges move: these are those of one instant and tell no stability (withy modes "
               "--floquet looks at a whole turn)"
             : shaking_text(linear.shaking) +
                   ": these are those of one instant and tell no stability (withy modes --floquet with --period looks "
                   "at a period after which everything repeats)";
}

std::string note_of_changing(const LinearModel& linear, double time) {
  if (linear.changing.empty()) return {};
  return fmt::format("the gain of {} changes as time goes on: this is what it is at t = {:g} s",
                     quoted_list(linear.changing), time);
}

LinearModel linear_model(const Configuration& c, const Ports& ports) {
  const std::vector<LinearOutput> outputs = linear_outputs(c, ports.outputs);
  const bool sensors = std::any_of(outputs.begin(), outputs.end(), [](const LinearOutput& o) { return o.sensed >= 0; });
  SmallMotions motions(c, sensors ? c.prepared().scene.outputs : std::vector<SensorNode>());
  const std::vector<LinearInput> inputs = chosen_inputs(c, motions, ports.inputs);
  SampledLoads sampled(motions);
  LinearModel linear = about(c, motions, sampled);
  look(motions, sampled, inputs, outputs, linear);
  Eigen::MatrixXd efforts(motions.by_effort().cols(), static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    linear.inputs.push_back(inputs[k].column);
    efforts.col(static_cast<Eigen::Index>(k)) = inputs[k].efforts;
  }
  sample(sampled,
         {motions.A(), sampled.moved(sampled.efforts()), motions.by_effort() * efforts, sampled.felt(inputs), {}},
         linear);
  return linear;
}

}  // namespace withy::study
