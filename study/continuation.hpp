/// \file
/// Whether the steady states of a sweep continue each other.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "withy/study/configuration.hpp"

namespace withy::study {

/// How the steady state at a value is not the continuation of that at the value before, from which it was found.
enum class Jump {
  none,
  no_way_back,    ///< from it another state is found at the value before: what was there ends in between, as at a fold
  another_midway  ///< by way of the value midway another state is found: the step is too long to tell
};

/// Between neighbouring values of a sweep, each with the steady state found there.
/// \param midway gives the configuration at the value midway; nothing where there is none, as of whole numbers
Jump jump_between(Configuration before, const State& steady_before, const Configuration& here, const State& steady,
                  const std::function<std::optional<Configuration>()>& midway);

/// One or two sentences; empty where there is none.
std::string jump_text(Jump jump);

}  // namespace withy::study
