/// \file
/// Where an instance begins by the start values that were set.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "withy/bindings/fmi/instance.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/simulation/assembly.hpp"
#include "withy/scene/constraints.hpp"

namespace withy::fmi {
namespace {

/// What a host has set, by the speeds of the model.
GivenState set_by_host(const Layout& layout, const std::vector<char>& is_set) {
  GivenState given{std::vector<bool>(layout.speeds, false), std::vector<bool>(layout.speeds, false)};
  const auto note = [&](const Slot& slot) {
    for (std::size_t i = 0; i < slot.positions; ++i)
      for (std::size_t k = 0; is_set[slot.position + i] != 0 && k < slot.speeds; ++k)
        if (slot.positions != slot.speeds || k == i) given.positions[slot.speed + k] = true;
    for (std::size_t k = 0; k < slot.speeds; ++k)
      given.rates[slot.speed + k] = is_set[layout.positions + slot.speed + k] != 0;
  };
  std::for_each(layout.hinges.begin(), layout.hinges.end(), note);
  std::for_each(layout.bodies.begin(), layout.bodies.end(), note);
  return given;
}

/// What is wrong with a quaternion that has no direction, as of a host that begins with zeros; else empty. \param y as
/// State::y
std::string without_direction(const Model& model, std::span<const double> y) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const auto kernel = model.hinges()[h].hinge->kernel();
    if (!kernel || (kernel->kind != HingeKernel::Kind::spherical && kernel->kind != HingeKernel::Kind::free)) continue;
    const auto q = y.subspan(model.layout().hinges[h].position, 4);
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (std::isnormal(norm)) continue;
    const std::string& name = model.hinges()[h].name;
    return "hinge '" + name + "': got " + name + ".qw, qx, qy, qz = " + brief(q[0]) + ", " + brief(q[1]) + ", " +
           brief(q[2]) + ", " + brief(q[3]) + "; need a quaternion that is not zero";
  }
  return {};
}

}  // namespace

/// Begins the states of loads at what was set; before that closes loops that start values, or motions at another start
/// time, have opened. What was set stays, and what the scene gives stays as long as the rest can close the loops. It
/// goes from where the scene begins, whatever was closed before. \returns why that cannot be, or why a quaternion turns
/// nothing; else empty
std::string Instance::settle_start() {
  Dynamics& d = dynamics();
  if (!open_) return {};
  if (std::string fault = without_direction(d.model(), d.state().y); !fault.empty()) return fault;
  const Model& model = d.model();
  const std::vector<const LoopClosure*> loops = loops_of(model);
  const bool moved = std::find(is_started_.begin(), is_started_.end(), 1) != is_started_.end() ||
                     start_ != d.prepared().scene.initial.time;
  if (!loops.empty() && moved) {
    State state = d.state();
    const State initial = d.initial();
    for (std::size_t i = 0; i < d.states(); ++i) state.y[i] = is_started_[i] != 0 ? starts_[i] : initial.y[i];
    const GivenState given = set_by_host(model.layout(), is_started_);
    const GivenState kept = given_state(d.prepared().scene.source.find("initial"), model);
    const Assembly closed = assemble(model, *d.prepared().equations, given, state, &kept);
    if (!closed.fault.empty())
      return (closed.of_hinge ? "hinge '" : "constraint '") + closed.name + "': " + fault_and_remedy(closed);
    d.set_moving(std::span(state.y).first(d.states()));
  }
  begin_loads(d);
  open_ = false;
  return {};
}

}  // namespace withy::fmi
