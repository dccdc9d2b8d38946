/// \file
/// Modes of equal blades along a sweep, as curves of a Campbell diagram.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "withy/study/formulation_modes.hpp"

namespace withy {

/// A motion of equal blades as it is seen from where the rotor does not turn.
struct BladeBranch {
  std::string name;                         ///< "blade1.bending_z[1] forward"; of several of one name "… (2)"
  std::vector<const study::NamedMode*> at;  ///< one a value of the sweep; null where the value has none
};

/// Of the modes that oscillate, at each value the `count` lowest, those of one name: the n-th of it at each value is a
/// branch. In the order of their names; empty where no blades were seen. They point into `run`.
std::vector<BladeBranch> blade_branches(const study::ModesOf& run, std::size_t count);

/// Equal blades that were seen; 0: none at any value.
std::size_t blades_seen(const study::ModesOf& run);

}  // namespace withy
