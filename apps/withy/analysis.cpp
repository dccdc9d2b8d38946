#include "withy/apps/withy/analysis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/scene/units.hpp"

namespace withy::app {

using Json = nlohmann::ordered_json;

namespace {

bool rate_is_angular(const Model& model, std::size_t speed) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = model.layout().hinges[h];
    if (speed >= slot.speed && speed < slot.speed + slot.speeds)
      return hinge_rates(*model.hinges()[h].hinge)[speed - slot.speed].angular;
  }
  return false;
}

}  // namespace

Configuration::Configuration(const ConfigurationArguments& arguments)
    : engine_(arguments),
      dynamics_(engine_.scene().model, engine_.scene().formulation->terms()),
      state_(engine_.state(arguments.state)),
      held_(layout().speeds, false) {
  for (const DiscreteSlot& slot : layout().discrete_slots)
    throw InputError(arguments.scene + ": load '" + engine_.model().loads()[slot.load].name +
                     "' changes at instants (sampled, or a relay); linear analyses need loads that are continuous in "
                     "time: leave out its 'sample', or the load");
  engine_.model().prescribe(state_);
  for (const MotionNode& motion : engine_.model().motions()) {
    const Slot& slot = layout().hinges[static_cast<std::size_t>(motion.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i) held_[slot.speed + i] = true;
  }
  for (const std::string& name : arguments.lock) {
    for (const std::size_t s : speeds_of(name, "--lock")) held_[s] = true;
  }
  for (const std::string& text : arguments.spin) spin(read_spin(text, "--spin"));
}

void Configuration::spin(const SpunRate& rate) {
  held_[rate.speed] = true;
  state_.y[layout().positions + rate.speed] = rate.rate;
}

SpunRate Configuration::read_spin(const std::string& text, const std::string& option) const {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw InputError(option + ": got '" + text + "'; need HINGE=RATE, as axle=6 or axle='60 rev/min'");
  const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
  const std::vector<std::size_t> speeds = speeds_of(name, option);
  if (speeds.size() != 1)
    throw InputError(fmt::format("{}: hinge '{}' has {} rates; name one, as {}.0", option, name, speeds.size(), name));
  std::optional<double> rate = plain_number(value);
  if (!rate) {
    const QuantityReading quantity =
        read_quantity(value, rate_is_angular(engine_.model(), speeds[0]) ? "rad/s" : "m/s");
    if (!quantity.value) throw InputError(option + ": rate of '" + name + "': " + quantity.problem);
    rate = quantity.value;
  }
  for (std::size_t h = 0; h < layout().hinges.size(); ++h) {
    const Slot& slot = layout().hinges[h];
    if (engine_.model().driven(h) && speeds[0] >= slot.speed && speeds[0] < slot.speed + slot.speeds)
      throw InputError(fmt::format("{}: a motion of the scene drives '{}' already", option, slot.name));
  }
  if (!std::isfinite(*rate)) throw InputError(option + ": rate of '" + name + "': need a finite number");
  return {speeds[0], *rate};
}

void Configuration::begin_at(const State& state) {
  const Layout& order = layout();
  const auto take = [&](const Slot& slot) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      if (held_[slot.speed + i]) return;
    }
    for (std::size_t i = 0; i < slot.positions; ++i) state_.y[slot.position + i] = state.y[slot.position + i];
  };
  for (const Slot& slot : order.hinges) take(slot);
  for (const Slot& slot : order.bodies) take(slot);
}

std::vector<std::size_t> Configuration::speeds_of(const std::string& name, const std::string& option) const {
  std::vector<std::size_t> speeds;
  if (const Slot* slot = layout().hinge(name)) {
    for (std::size_t i = 0; i < slot->speeds; ++i) speeds.push_back(slot->speed + i);
    if (speeds.empty()) throw InputError(fmt::format("{}: hinge '{}' has no rates", option, name));
    return speeds;
  }
  for (const std::size_t s : hinge_speeds()) {
    if (layout().speed_names[s] == name) return {s};
  }
  std::string known;
  for (const Slot& slot : layout().hinges) {
    if (slot.speeds > 0) known += (known.empty() ? "" : ", ") + slot.name;
  }
  throw InputError(fmt::format("{}: no hinge '{}'; known: {}", option, name, known));
}

std::vector<std::size_t> Configuration::hinge_speeds() const {
  std::vector<std::size_t> speeds;
  for (const Slot& slot : layout().hinges) {
    for (std::size_t i = 0; i < slot.speeds; ++i) speeds.push_back(slot.speed + i);
  }
  return speeds;
}

std::vector<std::string> held_names(const Configuration& c) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < c.held().size(); ++s) {
    if (c.held()[s]) names.push_back(c.layout().speed_names[s]);
  }
  return names;
}

std::string no_steady_state(const Configuration& c, const SteadyState& steady) {
  if (steady.converged) return {};
  std::string text = fmt::format("no steady state was found: after {} steps of Newton's method ", steady.iterations);
  std::size_t worst = 0;
  double left = 0;
  for (std::size_t s = 0; s < c.held().size(); ++s) {
    const double effort = std::abs(steady.efforts[static_cast<Eigen::Index>(s)]);
    if (c.held()[s] || !(effort > left)) continue;
    left = effort;
    worst = s;
  }
  text += fmt::format("{:.3g} are left over on {}", left, c.layout().speed_names[worst]);
  if (steady.neutral.size() > 0) {
    Eigen::Index weakest = 0;
    steady.neutral.cwiseAbs().maxCoeff(&weakest);
    text += fmt::format("; nothing holds {}: lock its hinge, give it a spring, or start from another state",
                        c.layout().speed_names[static_cast<std::size_t>(weakest)]);
  } else {
    text += "; start from a state nearer to one (--at), or approach the load in steps (withy modes --sweep)";
  }
  return text;
}

std::string derivatives_text(const Tangents& tangents) {
  if (tangents.differenced.empty()) return "exact";
  std::string names;
  for (const std::string& n : tangents.differenced) names += (names.empty() ? "" : ", ") + n;
  return "exact but for the loads " + names + ", by central differences of eighth order";
}

Json steady_json(const Configuration& c, const SteadyState& steady) {
  Json efforts = Json::object();
  for (std::size_t s = 0; s < c.held().size(); ++s) {
    if (c.held()[s]) efforts[c.layout().speed_names[s]] = steady.efforts[static_cast<Eigen::Index>(s)];
  }
  double left = 0;
  for (const Eigen::Index s : free_speeds(c.held())) left = std::max(left, std::abs(steady.efforts[s]));
  Json j;
  j["converged"] = steady.converged;
  j["iterations"] = steady.iterations;
  j["residual"] = left;
  j["efforts"] = std::move(efforts);
  j["state"] = Json::parse(write_state(c.engine().model(), steady.state));
  return j;
}

}  // namespace withy::app
