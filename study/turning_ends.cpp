#include "withy/study/turning_ends.hpp"

#include <algorithm>

#include "withy/core/model/switched_load.hpp"
#include "withy/core/plugin/changing_law.hpp"

namespace withy::study {
namespace {

bool among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// What the numbers first … first + count become, one for all.
GoingOn together(const std::vector<GoingOn>& all, std::size_t first, std::size_t count) {
  GoingOn any;
  for (std::size_t i = first; i < first + count; ++i) {
    any.moves = any.moves || all[i].moves, any.timed = any.timed || all[i].timed;
    any.turns = any.turns || all[i].turns, any.shakes = any.shakes || all[i].shakes;
  }
  return any;
}

/// Efforts on free speeds and rates of continuous states of loads.
Eigen::VectorXd felt_at(const SmallMotions& motions, const State& state) {
  const Eigen::VectorXd efforts = motions.efforts(state), rates = motions.rates(state);
  const auto m = static_cast<Eigen::Index>(motions.free().size());
  Eigen::VectorXd all(m + rates.size());
  all << efforts(motions.free()), rates;
  return all;
}

/// What becomes of what a sampled load holds, in what small motions feel of it.
GoingOn of_what_is_held(const Configuration& c, const SmallMotions& motions, const StatesToCome& states,
                        const LoadSlot& slot) {
  const auto displaced = [&](const State& from, double steps) {
    State state = from;
    for (std::size_t i = slot.first; i < slot.first + slot.count; ++i)
      state.y[i] += steps * 1e-2 * std::max(1.0, std::abs(from.y[i]));
    return state;
  };
  const std::size_t count = motions.free().size() + c.layout().continuous;
  const std::vector<GoingOn> all = states.look([&](const State& state) { return felt_at(motions, state); },
                                               std::vector<std::string>(count, "felt"), displaced);
  return together(all, 0, count);
}

/// The state with what is pushed in another, of the same place and time.
State pushed_at(const Configuration& c, const State& there, State pushed) {
  std::copy_n(there.y.begin(), c.layout().moving(), pushed.y.begin());
  pushed.time = there.time;
  return pushed;
}

/// Whether one unit of an input does something else as hinges go on.
bool input_turns(const Configuration& c, const SmallMotions& motions, const LinearInput& input,
                 const StatesToCome& states) {
  const auto of_unit = [&](const State& there) -> Eigen::VectorXd {
    const Eigen::VectorXd by = motions.efforts(pushed_at(c, there, input.state_at(1))) -
                               motions.efforts(pushed_at(c, there, input.state_at(-1)));
    return by(motions.free());
  };
  const std::size_t count = motions.free().size();
  return together(states.look(of_unit, std::vector<std::string>(count, "effort"), {}, true), 0, count).moves;
}

/// What of the sensors' numbers follows one unit of an input at once, or of all that do not turn: D.
std::vector<GoingOn> followed_at_once(const Configuration& c, SmallMotions& motions, const LinearInput& input,
                                      const std::vector<std::string>& units, const StatesToCome& states) {
  const double step = motions.step(input.efforts);
  const auto of_input = [&](const State& there) -> Eigen::VectorXd {
    return motions.sensed(pushed_at(c, there, input.state_at(step))) -
           motions.sensed(pushed_at(c, there, input.state_at(-step)));
  };
  return states.look(of_input, units, {}, true);
}

/// Of outputs that have rows: values, then rows, as they are at a state.
Eigen::VectorXd rows_at(const Configuration& c, const SmallMotions& motions, const std::vector<std::string>& names,
                        const State& there) {
  Configuration at = c;
  at.set_state(pushed_at(c, there, c.state()));
  const auto width = 1 + 2 * static_cast<Eigen::Index>(motions.free().size());
  const std::vector<LinearOutput> outputs = linear_outputs(at, names);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(width * static_cast<Eigen::Index>(outputs.size()));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    if (outputs[k].sensed >= 0) continue;
    all.segment(width * static_cast<Eigen::Index>(k), width) << outputs[k].value,
        row_of_free(outputs[k], motions.free()).transpose();
  }
  return all;
}

/// Outputs that have rows, one each; nothing of sensors.
std::vector<GoingOn> rows_to_come(const Configuration& c, const SmallMotions& motions,
                                  const std::vector<LinearOutput>& outputs, const std::vector<std::string>& names,
                                  const StatesToCome& states) {
  std::vector<GoingOn> all(outputs.size());
  const std::size_t width = 1 + 2 * motions.free().size();
  std::vector<std::string> groups;
  for (const LinearOutput& o : outputs) {
    groups.push_back(o.column.unit);
    groups.insert(groups.end(), width - 1, "row");
  }
  const std::vector<GoingOn> each =
      states.look([&](const State& there) { return rows_at(c, motions, names, there); }, groups, {}, true);
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    all[k] = each[k * width];
    const GoingOn row = together(each, k * width + 1, width - 1);
    all[k].turns = row.moves, all[k].shakes = row.timed;
  }
  return all;
}

/// All numbers of sensors, what sampled loads tell as of a sample at each instant.
std::vector<GoingOn> sensed_to_come(const Configuration& c, SmallMotions& motions, SampledLoads& sampled,
                                    const std::vector<LinearInput>& inputs, const std::vector<std::string>& turning,
                                    const StatesToCome& states) {
  std::vector<std::string> units;
  for (const Column& column : motions.columns()) units.push_back(column.unit);
  const auto sensed = [&](const State& there) { return motions.sensed(sampled.told_at(there)); };
  std::vector<GoingOn> all = states.look(sensed, units, states.everything());
  for (const LinearInput& input : inputs) {
    // What an input does that turns is told of the input, whatever sees it.
    if (among(turning, input.column.name)) continue;
    const std::vector<GoingOn> at_once = followed_at_once(c, motions, input, units, states);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].turns = all[i].turns || at_once[i].moves;
      all[i].shakes = all[i].shakes || at_once[i].timed;
    }
  }
  return all;
}

}  // namespace

SampledToCome sampled_to_come(const Configuration& c, const SmallMotions& motions, SampledLoads& sampled,
                              const StatesToCome& states) {
  SampledToCome found;
  if (sampled.none()) return found;
  const std::vector<std::string> known = changing_loads(c);
  const std::vector<LoadSlot> slots = sampled_slots(c.prepared().model());
  std::vector<std::string> groups;
  for (const LoadSlot& slot : slots)
    groups.insert(groups.end(), slot.count, c.prepared().model().loads()[slot.load].name);
  const std::vector<GoingOn> renewed =
      states.look([&](const State& there) { return sampled.renewed(there); }, groups, states.everything());
  std::size_t first = 0;
  for (const LoadSlot& slot : slots) {
    GoingOn load = together(renewed, first, slot.count);
    first += slot.count;
    const auto [column, count] = sampled.held_by(slot.load);
    const bool felt = !sampled.moved(sampled.efforts()).middleCols(column, count).isZero(0);
    if (!felt && !sampled.measured_by_others(slot.load)) continue;
    if (felt) {
      const GoingOn held = of_what_is_held(c, motions, states, slot);
      load.turns = load.turns || held.turns, load.shakes = load.shakes || held.shakes;
    }
    const std::string& name = c.prepared().model().loads()[slot.load].name;
    if (load.moves) found.moving.push_back(name);
    if (load.timed) found.timed.push_back(name);
    if (load.turns) found.turning.push_back(name);
    if (load.shakes && !among(known, name)) found.shaking.push_back(name);
  }
  return found;
}

SampledToCome sampled_to_come(const Configuration& c, const State& steady, const Turning& turning, bool pushed,
                              double period) {
  Configuration about = c;
  about.set_state(steady);
  const SmallMotions motions(about, {});
  SampledLoads sampled(motions);
  return sampled_to_come(about, motions, sampled, StatesToCome(about, motions, turning, pushed, period == 0));
}

bool load_changes(const SmallMotions& motions, const StatesToCome& states, std::size_t load) {
  const std::size_t count = motions.free().size();
  const auto efforts = [&](const State& there) -> Eigen::VectorXd {
    const Eigen::VectorXd all = motions.efforts(there, load);
    return all(motions.free());
  };
  const GoingOn any =
      together(states.look(efforts, std::vector<std::string>(count, "effort"), states.everything()), 0, count);
  return any.turns || any.shakes;
}

EndsToCome ends_to_come(const Configuration& c, SmallMotions& motions, SampledLoads& sampled,
                        const std::vector<LinearInput>& inputs, const std::vector<LinearOutput>& outputs,
                        const std::vector<std::string>& names, const StatesToCome& states) {
  EndsToCome found;
  for (const LinearInput& input : inputs)
    if (input_turns(c, motions, input, states)) found.inputs.push_back(input.column.name);
  const auto has = [&](bool sensed) {
    return std::any_of(outputs.begin(), outputs.end(),
                       [&](const LinearOutput& o) { return (o.sensed >= 0) == sensed; });
  };
  const std::vector<GoingOn> rows =
      has(false) ? rows_to_come(c, motions, outputs, names, states) : std::vector<GoingOn>(outputs.size());
  const std::vector<GoingOn> sensed =
      has(true) ? sensed_to_come(c, motions, sampled, inputs, found.inputs, states) : std::vector<GoingOn>();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const LinearOutput& o = outputs[k];
    const GoingOn& g = o.sensed >= 0 ? sensed[static_cast<std::size_t>(o.sensed)] : rows[k];
    if (g.turns) found.outputs.push_back(o.column.name);
    // Of a body that is pushed its acceleration, and what bears that, is what time makes of them.
    if (g.shakes && !states.pushed()) found.timed.push_back(o.column.name);
    if (g.moves || g.timed) found.moving.push_back(o.column.name);
  }
  return found;
}

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

}  // namespace withy::study
