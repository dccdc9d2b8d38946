/// \file
/// Whether steps come to nothing where a motion has lost its inertia.
#pragma once

#include <string>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// With its own energy conserved the rate of a motion grows without bound as its inertia goes to zero, within a finite
/// time: steps shrink, the more of them the smaller the tolerance, until time resolves no more. Looked at each time
/// that the steps have doubled.
class CreepWatch {
 public:
  /// \param own_energy whether the formulation truncates its energy (RunOptions::own_energy): M of others that are
  /// symmetric loses no inertia
  CreepWatch(const EquationsOfMotion& equations, State initial, bool own_energy);

  /// Why the steps are to end; empty: they are not. \param stepper between two steps
  std::string fault(const Stepper& stepper);
  void remember(Memory& memory);

 private:
  /// Whether the later half of the steps has gained next to nothing.
  bool creeps(const Stepper& stepper);
  /// Whether M has lost a motion's inertia since the start, or gives it a negative one.
  [[nodiscard]] bool without_inertia(const State& state) const;

  const EquationsOfMotion& equations_;
  State initial_;
  bool own_energy_;
  std::size_t half_ = 1024;  ///< of the steps made, when they were looked at last
  double half_time_;         ///< when these were made [s]
};

}  // namespace withy
