/// \file
/// The equations of motion at one state, for eyes and for programs that check them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "withy/study/prepared.hpp"

namespace withy {

struct Evaluated {
  /// Mass matrix, forces, accelerations (null where there are none), efforts of motions, gaps and multipliers of loops,
  /// energies, momenta, condition.
  nlohmann::ordered_json json;
  std::string problem;  ///< why there are no accelerations; empty where there are
};

/// \param state what its loads hold and remember need not have begun: it begins as that of a run does
Evaluated evaluate(const study::Prepared& prepared, const State& state);

}  // namespace withy
