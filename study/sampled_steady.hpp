/// \file
/// Steady states of configurations, with what sampled loads hold.
#pragma once

#include "withy/study/configuration.hpp"

namespace withy::study {

/// find_steady_state; where loads are sampled, with all that they hold as it is after each sample: what a sample leaves
/// as it is, every later one does; what they tell is of such a sample. Newton's method for displacements, continuous
/// states and what is held together. \throws std::domain_error, InputError where small motions cannot be found
SteadyState steady_state_of(const Configuration& configuration);
/// Whether its state is one: is_steady_state; where loads are sampled, by what the method above would still change.
/// \throws std::domain_error where small motions cannot be found
bool is_steady(const Configuration& configuration);

}  // namespace withy::study
