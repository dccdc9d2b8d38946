#include "withy/core/simulation/creep_watch.hpp"

#include <utility>

#include "withy/core/simulation/diagnosis.hpp"

namespace withy {

CreepWatch::CreepWatch(const EquationsOfMotion& equations, State initial, bool own_energy)
    : equations_(equations), initial_(std::move(initial)), own_energy_(own_energy) {}

std::string CreepWatch::fault(const TwoHalves& steps, const State& state) const {
  constexpr double next_to_nothing = 0.01;
  const bool creeps = steps.now - steps.middle < next_to_nothing * (steps.middle - steps.begun);
  if (!own_energy_ || !creeps || !without_inertia(state)) return {};
  return "the steps come to nothing: half of the " + std::to_string(steps.made) +
         " made have gained less than a hundredth of the time";
}

bool CreepWatch::without_inertia(const State& state) const {
  if (equations_.layout().speeds > largest_examined) return false;
  MassMatrixHistory history = examine(equations_, initial_, state, {});
  compare_inertia(history);
  return history.nearly_singular() || history.has_negative_inertia();
}

}  // namespace withy
