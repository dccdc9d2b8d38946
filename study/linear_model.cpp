#include "withy/study/linear_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/analysis/steady_state.hpp"
#include "withy/core/analysis/turn.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/linear_inputs.hpp"
#include "withy/study/linear_outputs.hpp"
#include "withy/study/linear_parts.hpp"
#include "withy/study/narrow_loads.hpp"
#include "withy/study/sampled_steady.hpp"
#include "withy/study/time_laws.hpp"
#include "withy/study/timed_loads.hpp"
#include "withy/study/turning.hpp"
#include "withy/study/turning_ends.hpp"

namespace withy::study {
namespace {

/// Whether no mode moves; hinges may turn steadily.
bool no_mode_moves(const Configuration& c) {
  for (const Slot& slot : c.layout().bodies) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      if (c.state().y[c.layout().positions + slot.speed + i] != 0) return false;
    }
  }
  return true;
}

std::string quoted_list(const std::vector<std::string>& names) { return fmt::format("'{}'", fmt::join(names, "', '")); }

/// Whether motions move their hinges: what begins to move is where it is.
bool motions_move(const Configuration& c) {
  const std::vector<MotionNode>& motions = c.prepared().model().motions();
  return std::any_of(motions.begin(), motions.end(),
                     [&](const MotionNode& node) { return node.motion->at(c.state().time).rate != 0; });
}

/// Whether A is that of one angle, however what is free is balanced.
bool is_of_one_angle(TurnCheck turn) {
  turn.steady = true;
  return turn.periodic();
}

/// Loads by which time changes A. What goes in is as the state has it, whatever a run is given later.
std::vector<std::string> without_inputs(const Configuration& c, std::vector<std::string> names) {
  for (const LoadNode& node : c.prepared().model().loads())
    if (node.load->input() != nullptr) names.erase(std::remove(names.begin(), names.end(), node.name), names.end());
  return names;
}

/// What of inputs and outputs is that of one instant, where A is not.
void look_at_ends(const Configuration& c, SmallMotions& motions, SampledLoads& sampled,
                  const std::vector<LinearInput>& inputs, const std::vector<LinearOutput>& outputs,
                  const std::vector<std::string>& names, const StatesToCome& states, LinearModel& linear) {
  EndsToCome ends = ends_to_come(c, motions, sampled, inputs, outputs, names, states);
  linear.turning_inputs = std::move(ends.inputs), linear.turning_outputs = std::move(ends.outputs);
  linear.timed_outputs = std::move(ends.timed), linear.moving_outputs = std::move(ends.moving);
  linear.frozen = !(linear.turning_inputs.empty() && linear.turning_outputs.empty() && linear.timed_outputs.empty());
}

/// C, D of the outputs in continuous time, and by what is held and told (columns after those of the states).
void look(SmallMotions& motions, const SampledLoads& sampled, const std::vector<LinearInput>& inputs,
          const std::vector<LinearOutput>& outputs, LinearModel& linear) {
  const Eigen::Index n = motions.size(), rows = static_cast<Eigen::Index>(outputs.size());
  LinearSystem& s = linear.system;
  s.C.setZero(rows, n + sampled.size() + sampled.told());
  s.D.setZero(rows, static_cast<Eigen::Index>(inputs.size()));
  const bool sensors = std::any_of(outputs.begin(), outputs.end(), [](const LinearOutput& o) { return o.sensed >= 0; });
  SensedDerivatives seen;
  Eigen::MatrixXd by_held, by_told, by_input;
  if (sensors) {
    seen = sensed_derivatives(motions);
    by_held.resize(seen.values.size(), sampled.size());
    by_told.resize(seen.values.size(), sampled.told());
    by_input.resize(seen.values.size(), s.D.cols());
    for (Eigen::Index i = 0; i < sampled.size(); ++i) {
      const auto held_at = [&](double h) { return sampled.displaced(h * Eigen::VectorXd::Unit(sampled.size(), i)); };
      by_held.col(i) = sensed_slope(motions, held_at, motions.step(sampled.efforts().col(i)));
    }
    for (Eigen::Index i = 0; i < sampled.told(); ++i)
      by_told.col(i) = sensed_slope(
          motions, [&](double h) { return sampled.told_displaced(i, h); }, 1e-2);
    for (std::size_t k = 0; k < inputs.size(); ++k)
      by_input.col(static_cast<Eigen::Index>(k)) =
          sensed_slope(motions, inputs[k].state_at, motions.step(inputs[k].efforts));
  }
  double uncertainty = 1e-15;  // of those asked for
  for (Eigen::Index k = 0; k < rows; ++k) {
    const LinearOutput& o = outputs[static_cast<std::size_t>(k)];
    linear.outputs.push_back(o.column);
    linear.output_values.push_back(o.sensed >= 0 ? seen.values[o.sensed] : o.value);
    if (o.sensed < 0) {
      const Eigen::RowVectorXd row = row_of_free(o, motions.free());
      s.C.row(k).head(row.size()) = row;
      continue;
    }
    s.C.row(k) << seen.by_state.row(o.sensed), by_held.row(o.sensed), by_told.row(o.sensed);
    s.D.row(k) = by_input.row(o.sensed);
    uncertainty = std::max(uncertainty, seen.uncertainty[o.sensed]);
  }
  linear.output_derivatives =
      sensors ? fmt::format("exact but for sensors, by central differences of eighth order, to {:.1g}", uncertainty)
              : "exact";
}

}  // namespace

About about(const Configuration& c, const SmallMotions& motions, SampledLoads& sampled) {
  LinearModel linear;
  linear.states = motions.names();
  linear.states.insert(linear.states.end(), sampled.names().begin(), sampled.names().end());
  linear.derivatives = motions.derivatives();
  for (const Eigen::Index s : motions.free())
    linear.accelerations.emplace_back(c.layout().speed_names[static_cast<std::size_t>(s)], motions.accelerations()[s]);
  linear.changing = changing_loads(c);
  linear.limited = at_limits(c, c.state());
  TurnCheck turn = check_turn(c.dynamics(), c.state(), c.held());
  meet_narrow_loads(c, c.state(), turn);
  const TimedLoads timed = timed_loads(c, c.state(), turn.turning, Shaken::all);
  const bool turns = is_of_one_angle(turn);
  if (!turns) linear.shaking = without_inputs(c, timed.shaking);
  const std::vector<std::size_t> uneven = uneven_motions(c.dynamics(), c.state(), c.held());
  StatesToCome states(c, motions, turn.turning, timed.any_pushes || !uneven.empty(), uneven.empty() || motions_move(c));
  if (!turns && linear.shaking.empty()) {
    SampledToCome to_come = sampled_to_come(c, motions, sampled, states);
    linear.shaking = std::move(to_come.shaking), linear.turning_loads = std::move(to_come.turning);
  }
  linear.shaking = with_the_time(c, c.state(), turn.turning, linear.shaking);
  linear.frozen = turns || !linear.shaking.empty() || !linear.turning_loads.empty();
  linear.equilibrium = no_mode_moves(c) && is_steady(c) && uneven.empty();
  return {std::move(linear), std::move(states)};
}

void sample(const SampledLoads& sampled, const SampledLoads::Held& held, LinearModel& linear) {
  LinearSystem& system = linear.system;
  if (sampled.none()) {
    system.A = held.A, system.B = held.B;
    return;
  }
  auto [Phi, Gamma] = sampled.map(held);
  system.A = std::move(Phi), system.B = std::move(Gamma);
  system.C = system.C * sampled.shown(held);
  system.period = sampled.period();
  if (held.felt.empty()) return;
  for (const Column& input : linear.inputs) linear.states.push_back(input.name + ".before");
}

std::string note_of_frozen(const LinearModel& linear) {
  constexpr const char* one_instant = "these are those of one instant and tell no stability";
  if (!linear.frozen) return {};
  if (!linear.shaking.empty())
    return fmt::format("{}: {} (withy modes --floquet with --period looks at a period after which everything repeats)",
                       shaking_text(linear.shaking), one_instant);
  const auto text = [&](const std::vector<std::string>& names, const char* verb, const char* singular, const char* as,
                        const char* remedy) {
    if (names.empty()) return std::string();
    return fmt::format(
        "what {} {} small motions changes as {}: this is the response of one instant, none to a frequency "
        "that goes on, and tells no stability{}",
        quoted_list(names), names.size() > 1 ? verb : singular, as, remedy);
  };
  std::string all;
  for (const std::string& note :
       {text(linear.turning_loads, "make of", "makes of", "hinges move", ""),
        text(linear.turning_inputs, "do to", "does to", "hinges move",
             " (a force that turns with its frame, following: true, has one)"),
        text(linear.turning_outputs, "show of", "shows of", "hinges move",
             " (an output in axes that turn too, in: own or in: a frame that turns, has one)"),
        text(linear.timed_outputs, "show of", "shows of", "time goes on", "")})
    if (!note.empty()) all += (all.empty() ? "" : "; ") + note;
  if (!all.empty()) return all;
  return fmt::format(
      "the equations change as hinges move: {} (withy modes --floquet looks at a whole "
      "turn)",
      one_instant);
}

std::string note_of_moving(const LinearModel& linear) {
  if (linear.frozen || linear.moving_outputs.empty()) return {};
  return fmt::format("{} {} as hinges or time go on: this is the response of deviations from that",
                     quoted_list(linear.moving_outputs), linear.moving_outputs.size() > 1 ? "move" : "moves");
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
  auto [linear, states] = about(c, motions, sampled);
  if (!linear.frozen) look_at_ends(c, motions, sampled, inputs, outputs, ports.outputs, states, linear);
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
