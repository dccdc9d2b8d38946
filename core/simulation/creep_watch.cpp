#include "withy/core/simulation/creep_watch.hpp"

#include <utility>

#include "withy/core/simulation/diagnosis.hpp"

namespace withy {

CreepWatch::CreepWatch(const EquationsOfMotion& equations, State initial, bool own_energy)
    : equations_(equations), initial_(std::move(initial)), own_energy_(own_energy), half_time_(initial_.time) {}

std::string CreepWatch::fault(const Stepper& stepper) {
  if (!own_energy_ || !creeps(stepper) || !without_inertia(stepper.state())) return {};
  return "the steps come to nothing: half of the " + std::to_string(stepper.statistics().accepted) +
         " made have gained less than a hundredth of the time";
}

bool CreepWatch::creeps(const Stepper& stepper) {
  constexpr double next_to_nothing = 0.01;
  const std::size_t made = stepper.statistics().accepted;
  if (made < 2 * half_) return false;
  const double t = stepper.state().time, before = half_time_;
  half_ = made;
  half_time_ = t;
  return t - before < next_to_nothing * (before - initial_.time);
}

bool CreepWatch::without_inertia(const State& state) const {
  if (equations_.layout().speeds > largest_examined) return false;
  MassMatrixHistory history = examine(equations_, initial_, state, {});
  compare_inertia(history);
  return history.nearly_singular() || history.has_negative_inertia();
}

void CreepWatch::remember(Memory& memory) {
  memory(half_);
  memory(half_time_);
}

}  // namespace withy
