#include "withy/study/configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/event_plan.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/plugin/digital_part.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/simulation/assembly.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/scene/state_as_given.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/check_loads.hpp"
#include "withy/study/creep.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/own_equations.hpp"

namespace withy::study {
namespace {

/// Slots of discrete states that a clock renews, each behind how many of its first are told alone.
std::vector<std::pair<std::size_t, LoadSlot>> slots_by_the_clock(const Model& model) {
  std::vector<std::pair<std::size_t, LoadSlot>> slots;
  for (const LoadSlot& slot : model.layout().discrete_slots) {
    const DiscretePart* part = model.loads()[slot.load].load->discrete();
    if (!(part->period() > 0)) continue;
    const auto* digital = dynamic_cast<const DigitalPart*>(part);
    slots.emplace_back(digital == nullptr ? 0 : digital->told(), slot);
  }
  return slots;
}

/// The one speed of a hinge, or of that name.
std::size_t one_speed(const Model& model, const std::string& name, const std::string& what) {
  const std::vector<std::size_t> speeds = speeds_of(model, name, what);
  if (speeds.size() == 1) return speeds[0];
  throw OptionError(what, fmt::format("hinge '{}' has {} rates; name one, as {}.0", name, speeds.size(), name));
}

/// The hinge that a speed belongs to.
std::size_t hinge_of(const Layout& layout, std::size_t speed) {
  std::size_t h = 0;
  while (speed < layout.hinges[h].speed || speed >= layout.hinges[h].speed + layout.hinges[h].speeds) ++h;
  return h;
}

/// \throws InputError where a load's discrete part has no place in a linear analysis.
void require_no_switches(const std::string& file, const Model& model, const LoadSlot& slot) {
  const LoadNode& node = model.loads()[slot.load];
  if (node.load->input() != nullptr) return;
  const DiscretePart& part = *node.load->discrete();
  // What events alone change is constant here.
  if (part.switches() == 0 && !(part.period() > 0)) return;
  if (dynamic_cast<const ForeignLaw*>(node.load.get()) != nullptr)
    throw InputError(
        file + ": load '" + node.name +
        "' is sampled, and what its law remembers between two samples is kept elsewhere than in the state: "
        "it cannot be displaced, and there is no linear model of it; leave it out");
  if (part.switches() > 0)
    throw InputError(file + ": load '" + node.name +
                     "' changes at instants (a relay); linear analyses need loads that do not: leave it out (--set "
                     "loads." +
                     node.name + "=null)");
}

/// The state with all loads begun. One that waits for its next sample takes it here: small motions are about loads that
/// act, and the analyses hold time still, so that no sample would come.
State all_begun(const Model& model, const EquationsOfMotion& equations, State state) {
  state = begun(model, equations, std::move(state));
  Renewal renewal(model, equations);
  renewal.at(state);
  for (const LoadSlot& slot : sampled_slots(model)) {
    const auto* digital = dynamic_cast<const DigitalPart*>(model.loads()[slot.load].load->discrete());
    if (digital != nullptr && digital->waits(model.loads()[slot.load].discrete(std::span<const double>(state.y))))
      renewal(state, slot, {});
  }
  return state;
}

/// What the scene's integrator lets coordinates be off by [rad, m]; 0 where it has no tolerance.
double tolerance_of(const Scene& scene) {
  const Value* given = scene.source.at("integrator").find("atol");
  return given != nullptr && given->kind() == Value::Kind::number ? given->number() : 0;
}

}  // namespace

Configuration::Configuration(const Prepared& prepared, StateAsGiven start, const Holding& holding)
    : prepared_(prepared),
      dynamics_(prepared.scene.model, prepared.scene.formulation->terms()),
      state_(std::move(start.state)),
      held_(layout().speeds, false),
      follows_(held_) {
  const Model& model = prepared_.model();
  for (const LoadSlot& slot : layout().discrete_slots) require_no_switches(prepared.scene.file, model, slot);
  check_own_equations(prepared, state_);
  model.prescribe(state_);
  rest_loops();
  close_loops(start, holding);
  state_ = all_begun(model, *prepared_.equations, std::move(state_));
  check_load_derivatives(prepared_, state_);
  for (const MotionNode& motion : model.motions()) {
    const Slot& slot = layout().hinges[static_cast<std::size_t>(motion.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i) held_[slot.speed + i] = true;
  }
  for (const std::size_t hinge : locked_hinges(model, state_)) {
    const Slot& slot = layout().hinges[hinge];
    for (std::size_t i = 0; i < slot.speeds; ++i) held_[slot.speed + i] = true;
  }
  for (const std::string& name : holding.locked) {
    for (const std::size_t s : speeds_of(model, name, "lock")) {
      if (model.driven(hinge_of(layout(), s)))
        throw OptionError("lock",
                          fmt::format("a motion of the scene drives '{}': leave that motion out, or do not lock",
                                      layout().hinges[hinge_of(layout(), s)].name));
      held_[s] = true;
    }
  }
  for (const Spin& spun : holding.spun) spin(spun);
  dynamics_.keep_closed(prepared_.equations, state_, held_);
  follows_ = dynamics_.follows();
  for (std::size_t s = 0; s < held_.size(); ++s) held_[s] = held_[s] || follows_[s];
  state_ = without_creep(dynamics_, std::move(state_), held_, tolerance_of(prepared_.scene));
  if (dynamics_.singular(state_.y))
    throw InputError(
        prepared_.scene.file +
        ": the closed loops are in a singular configuration, about which there are no small motions: start from "
        "another state. A straight beam between supports that cannot come nearer needs 'extension'");
}

void Configuration::close_loops(const StateAsGiven& start, const Holding& holding) {
  const Model& model = prepared_.model();
  if (loops_of(model).empty()) return;
  // What carries a loop closes none.
  std::vector<bool> stays = speeds_in_loops(model);
  stays.flip();
  for (const std::string& name : holding.locked)
    for (const std::size_t s : speeds_of(model, name, "lock")) stays[s] = true;
  const GivenState* named = start.named.positions.empty() ? nullptr : &start.named;
  const std::vector<double> before = state_.y;
  Assembly closed = assemble(model, *prepared_.equations, {stays, stays}, state_, named);
  if (!closed.fault.empty())
    throw InputError(fmt::format("{}: {} '{}': {}{}", prepared_.scene.file, closed.of_hinge ? "hinge" : "constraint",
                                 closed.name, closed.fault,
                                 closed.remedy.empty() ? "" : "; begin at a state that is nearer to closed"));
  closing_ = std::move(closed.remark);
  if (state_.y == before || start.begun.empty()) return;
  // Loads that measure what has moved.
  State anew = state_;
  model.begin_continuous(anew);
  for (std::size_t i = 0; i < start.begun.size(); ++i)
    if (start.begun[i]) state_.y[i] = anew.y[i];
}

void Configuration::rest_loops() {
  /// [rad/s, m/s] What integrators leave of a rest.
  constexpr double resting = 1e-6;
  const std::vector<bool> in_loops = speeds_in_loops(prepared_.model());
  Eigen::Map<Eigen::VectorXd> speeds(state_.y.data() + layout().positions, static_cast<Eigen::Index>(layout().speeds));
  for (std::size_t s = 0; s < in_loops.size(); ++s) {
    if (!in_loops[s]) continue;
    double& rate = speeds[static_cast<Eigen::Index>(s)];
    if (!(std::abs(rate) <= resting))
      throw InputError(fmt::format(
          "{}: {} is in a closed loop and moves, at {:.3g} a second: small motions, and what stays as it is, are told "
          "about loops at rest: let the rates in 'initial' be 0",
          prepared_.scene.file, layout().speed_names[s], rate));
    rate = 0;
  }
}

Held Configuration::kept() const {
  Held kept = held_;
  for (std::size_t s = 0; s < kept.size(); ++s) kept[s] = kept[s] && !follows_[s];
  return kept;
}

std::vector<std::string> Configuration::held_names() const {
  std::vector<std::string> names;
  const Held kept = this->kept();
  for (std::size_t s = 0; s < kept.size(); ++s) {
    if (kept[s]) names.push_back(layout().speed_names[s]);
  }
  return names;
}

void Configuration::spin(const Spin& spin) {
  const std::size_t speed = one_speed(prepared_.model(), spin.name, "spin");
  if (prepared_.model().driven(hinge_of(layout(), speed)))
    throw OptionError("spin", fmt::format("a motion of the scene drives '{}' already", spin.name));
  if (!std::isfinite(spin.rate)) throw OptionError("spin", "rate of '" + spin.name + "': need a finite number");
  if (spin.rate != 0 && hinges_in_loops(prepared_.model())[hinge_of(layout(), speed)])
    throw OptionError("spin", fmt::format("'{}' is in a closed loop, which changes its shape as it turns", spin.name));
  held_[speed] = true;
  state_.y[layout().positions + speed] = spin.rate;
}

void Configuration::begin_at(const State& state) {
  const Layout& order = layout();
  const auto take = [&](const Slot& slot) {
    for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) {
      if (held_[i] && !follows_[i]) return;
    }
    for (std::size_t i = 0; i < slot.positions; ++i) state_.y[slot.position + i] = state.y[slot.position + i];
  };
  for (const Slot& slot : order.hinges) take(slot);
  for (const Slot& slot : order.bodies) take(slot);
  for (std::size_t i = order.positions + order.speeds; i < order.moving(); ++i) state_.y[i] = state.y[i];
  for (const LoadSlot& slot : sampled_slots(prepared_.model()))
    for (std::size_t i = slot.first; i < slot.first + slot.count; ++i) state_.y[i] = state.y[i];
  // Its loops may have had other lengths.
  const State own = state_;
  dynamics_.displace(state_.y, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(order.speeds)));
  if (std::any_of(state_.y.begin(), state_.y.end(), [](double y) { return std::isnan(y); })) state_ = own;
}

bool Configuration::sampled() const { return !sampled_slots(prepared_.model()).empty(); }

std::vector<LoadSlot> sampled_slots(const Model& model) {
  std::vector<LoadSlot> slots;
  for (const auto& [told, slot] : slots_by_the_clock(model))
    slots.push_back({slot.load, slot.first + told, slot.count - told});
  return slots;
}

std::vector<LoadSlot> told_slots(const Model& model) {
  std::vector<LoadSlot> slots;
  for (const auto& [told, slot] : slots_by_the_clock(model)) slots.push_back({slot.load, slot.first, told});
  return slots;
}

State told_at(const Model& model, Renewal& renewal, State state) {
  const std::vector<LoadSlot> told = told_slots(model);
  // A load may measure what another tells, as it was before the sample.
  for (std::size_t pass = 0; pass < told.size(); ++pass) {
    State after = state;
    renewal.at(state);
    for (const LoadSlot& slot : told) renewal(after, slot, {});
    bool same = true;
    for (const LoadSlot& slot : told) {
      for (std::size_t i = slot.first; i < slot.first + slot.count; ++i) {
        same = same && state.y[i] == after.y[i];
        state.y[i] = after.y[i];
      }
    }
    if (same) break;
  }
  return state;
}

std::vector<std::string> sampled_names(const Model& model) {
  std::vector<std::string> names;
  for (const LoadSlot& slot : sampled_slots(model))
    for (std::size_t i = 0; i < slot.count; ++i)
      names.push_back(fmt::format("{}.held[{}]", model.loads()[slot.load].name, i));
  return names;
}

std::vector<std::size_t> speeds_of(const Model& model, const std::string& name, const std::string& what) {
  const Layout& layout = model.layout();
  std::vector<std::size_t> speeds;
  if (const Slot* slot = layout.hinge(name)) {
    for (std::size_t i = 0; i < slot->speeds; ++i) speeds.push_back(slot->speed + i);
    if (speeds.empty()) throw OptionError(what, fmt::format("hinge '{}' has no rates", name));
    return speeds;
  }
  for (const std::size_t s : hinge_speeds(layout)) {
    if (layout.speed_names[s] == name) return {s};
  }
  std::vector<std::string> known;
  for (const Slot& slot : layout.hinges)
    if (slot.speeds > 0) known.push_back(slot.name);
  throw OptionError(what, fmt::format("no hinge '{}'; known: {}", name, fmt::join(known, ", ")));
}

std::vector<std::size_t> hinge_speeds(const Layout& layout) {
  std::vector<std::size_t> speeds;
  for (const Slot& slot : layout.hinges) {
    for (std::size_t i = 0; i < slot.speeds; ++i) speeds.push_back(slot.speed + i);
  }
  return speeds;
}

bool rate_is_angular(const Model& model, const std::string& name, const std::string& what) {
  const std::size_t speed = one_speed(model, name, what);
  const std::size_t h = hinge_of(model.layout(), speed);
  return hinge_rates(*model.hinges()[h].hinge)[speed - model.layout().hinges[h].speed].angular;
}

Spin read_spin(const Model& model, const std::string& hinge, const std::string& rate, const std::string& what) {
  const bool angular = rate_is_angular(model, hinge, what);
  if (const std::optional<double> number = plain_number(rate)) return {hinge, *number};
  const char* unit = angular ? "rad/s" : "m/s";
  const QuantityReading quantity = read_quantity(rate, unit);
  if (!quantity.value)
    throw OptionError(what, fmt::format("rate of '{}': got '{}'{}; need a number in {}, or one with its unit{}", hinge,
                                        rate, quantity.problem.empty() ? "" : ": " + quantity.problem, unit,
                                        angular ? ", as '60 rev/min'" : ""));
  return {hinge, *quantity.value};
}

Holding read_holding(const Model& model, const std::vector<std::string>& lock, const std::vector<std::string>& spin) {
  Holding holding{lock, {}};
  for (const std::string& text : spin) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      throw OptionError("spin", "got '" + text + "'; need HINGE=RATE, as axle=6 or axle='60 rev/min'");
    holding.spun.push_back(read_spin(model, text.substr(0, equals), text.substr(equals + 1), "spin"));
  }
  return holding;
}

std::string derivatives_text(const Tangents& tangents) {
  std::string but;
  if (!tangents.differenced.empty()) but = fmt::format("the loads {}", fmt::join(tangents.differenced, ", "));
  if (tangents.loops) but += but.empty() ? "what closes loops" : " and what closes loops";
  return but.empty() ? "exact" : fmt::format("exact but for {}, by central differences of eighth order", but);
}

}  // namespace withy::study
