/// \file
/// The formulations that a run goes through, and when.
#pragma once

#include <cstddef>
#include <string>

#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/terms.hpp"

namespace withy {

/// A formulation that a run may be in; each keeps more than the one before it.
struct Rung {
  std::string name;
  Terms terms;
  const EquationsOfMotion* equations = nullptr;
};

/// A part of a run in one formulation.
struct Stretch {
  std::size_t rung = 0;
  double start = 0, end = 0;  ///< [s]
};

}  // namespace withy
