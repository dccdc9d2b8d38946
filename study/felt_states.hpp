/// \file
/// Which states of loads what is free feels.
#pragma once

#include <vector>

#include "withy/core/analysis/turn.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// True of those that are felt.
struct FeltStates {
  std::vector<bool> continuous;  ///< one a continuous state, in the order of State
  std::vector<bool> sampled;     ///< one a sampled load, in the order of sampled_slots: what it holds
};

/// A state is felt where it changes an effort on something free, the rate of another load's state that is felt, or what
/// a sampled load that is felt holds after a sample. Looked at with everything displaced, at the state and at some
/// times after it: what multiplies a displacement is felt too. What holds a hinge bears what acts on it.
FeltStates felt_states(const Configuration& configuration, const State& state, const Turning& turning);

}  // namespace withy::study
