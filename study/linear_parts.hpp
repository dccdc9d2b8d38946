/// \file
/// Parts that linear models are made of, whatever goes in and comes out.
#pragma once

#include "withy/study/linear_model.hpp"
#include "withy/study/sampled_loads.hpp"
#include "withy/study/states_to_come.hpp"

namespace withy::study {

/// What does not depend on inputs and outputs: names of states, accelerations, whether the state is an equilibrium.
/// Whether A is that of one instant, and the states to come in which the rest may be looked at.
struct About {
  LinearModel linear;
  StatesToCome states;
};
About about(const Configuration& configuration, const SmallMotions& motions, SampledLoads& sampled);
/// Gives a model, which has C by x, d and what is told, and D, its A and B: those of continuous time or, where loads
/// are sampled, of the map between samples, y then just after the sample; with states for what v was before where loads
/// feel it.
void sample(const SampledLoads& sampled, const SampledLoads::Held& held, LinearModel& linear);

}  // namespace withy::study
