/// \file
/// Least time from rest to rest of one or two hinges of a rigid tree under limited efforts: bang-bang efforts whose
/// switches are found by Newton's method and proved extremal by the maximum principle.
#pragma once

#include <optional>
#include <vector>

#include "withy/loads/limited_tree.hpp"

namespace withy {

/// Efforts that are at one limit or the other.
struct SwitchingPlan {
  struct Axis {
    double first = 0;              ///< effort at the start [N m, N]
    std::vector<double> switches;  ///< times [s], increasing, at which it is reversed
  };
  std::vector<Axis> axes;
  double end = 0;  ///< [s]
};

/// The fastest of the extremals found that have 1 switch for one axis; for two axes 3, or 4 if none has 3. Nothing
/// where none is found.
std::optional<SwitchingPlan> least_time(const LimitedTree& tree);

}  // namespace withy
