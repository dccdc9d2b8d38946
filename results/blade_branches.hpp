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
  std::size_t number = 0;                   ///< as study::BladeModes::branches has it
  std::string name;                         ///< of where it begins: "blade1.bending_z[1] forward"; of several "… (2)"
  std::vector<const study::NamedMode*> at;  ///< one a value of the sweep; null where the value has none
};

/// The branches that were followed which at some value are among the `count` lowest or grow, in the order in which they
/// begin; real exponents are of frequency zero. Rigid motions are left out; empty where no blades were seen. They point
/// into `run`.
std::vector<BladeBranch> blade_branches(const study::ModesOf& run, std::size_t count);

/// Growth up to this may be rounding [1/s]: 1e-10 of the greatest |λ|.
double growth_resolution(const study::BladeModes& seen);
/// Whether a mode of these grows beyond that.
bool grows(const study::BladeModes& seen, const study::NamedMode& mode);

/// Equal blades that were seen; 0: none at any value.
std::size_t blades_seen(const study::ModesOf& run);

}  // namespace withy
