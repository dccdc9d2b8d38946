/// \file
/// How large the terms are that a formulation drops, along a motion of it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "withy/study/prepared.hpp"

namespace withy::study {

/// A group of terms of the ledger that is dropped, as "f2-2".
struct DroppedTerm {
  std::string term;
  double share = 0;  ///< root mean square over that of the greatest term on the same coordinates
};

/// What is dropped from the forces on some coordinates.
struct DroppedForces {
  std::string group;  ///< "hinges", "bending", "torsion", "elastic"
  double share = 0;   ///< all of it together, as in DroppedTerm
  double spread = 0;  ///< by how much the share of every second state is another
  /// When the greatest term was so great that this one state has most of the sum of its squares [s]: shares say how it
  /// is there, as near a singular mass matrix, and not over the run.
  std::optional<double> moment = {};
  std::vector<DroppedTerm> terms = {};  ///< the greatest first; empty where the formulation is no sum of groups
};

/// From the states of a motion, at the accelerations that its own equations give. Nothing where there are none, or the
/// tree has loops.
/// \param beyond what they are dropped against
std::vector<DroppedForces> dropped_terms(const Prepared& prepared, const Beyond& beyond, std::span<const State> along,
                                         Registry& registry);

}  // namespace withy::study
