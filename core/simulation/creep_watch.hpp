/// \file
/// Whether steps come to nothing where a motion has lost its inertia.
#pragma once

#include <string>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/simulation/later_half.hpp"

namespace withy {

/// With its own energy conserved the rate of a motion grows without bound as its inertia goes to zero, within a finite
/// time: steps shrink, the more of them the smaller the tolerance, until time resolves no more.
class CreepWatch {
 public:
  /// \param own_energy whether the formulation truncates its energy (RunOptions::own_energy): M of others that are
  /// symmetric loses no inertia
  CreepWatch(const EquationsOfMotion& equations, State initial, bool own_energy);

  /// Why the steps are to end; empty: they are not. \param state between two steps, after these
  [[nodiscard]] std::string fault(const TwoHalves& steps, const State& state) const;

 private:
  /// Whether M has lost a motion's inertia since the start, or gives it a negative one.
  [[nodiscard]] bool without_inertia(const State& state) const;

  const EquationsOfMotion& equations_;
  State initial_;
  bool own_energy_;
};

}  // namespace withy
