/// \file
/// What of a linear model is that of one instant although masses, stiffnesses and what depends on speeds are constant:
/// inputs, outputs and sampled loads that change as hinges go on that move, or as time does.
#pragma once

#include <string>
#include <vector>

#include "withy/study/linear_inputs.hpp"
#include "withy/study/linear_outputs.hpp"
#include "withy/study/sampled_loads.hpp"
#include "withy/study/states_to_come.hpp"

namespace withy::study {

/// Sampled loads by what becomes of them.
struct SampledToCome {
  std::vector<std::string> moving;   ///< they command something else as hinges go on: no balance stays
  std::vector<std::string> timed;    ///< and as time does by itself
  std::vector<std::string> turning;  ///< what they make of small motions changes as hinges go on
  std::vector<std::string> shaking;  ///< and as time does; none of those whose gain is known to (`changing_loads`)
};

/// Looks at what is renewed and at what is felt of what is held; loads that nothing feels are left out.
SampledToCome sampled_to_come(const Configuration& configuration, const SmallMotions& motions, SampledLoads& sampled,
                              const StatesToCome& states);
/// The same about a steady state. \param period [s] known to the caller, as of check_turn; 0: time is looked at too
/// \throws InputError as SampledLoads; std::domain_error as SmallMotions
SampledToCome sampled_to_come(const Configuration& configuration, const State& steady, const Turning& turning,
                              bool pushed, double period);

/// Whether what a load makes of small motions changes as hinges go on, or as time does; loads by their index.
bool load_changes(const SmallMotions& motions, const StatesToCome& states, std::size_t load);

/// Inputs and outputs by what becomes of them.
struct EndsToCome {
  std::vector<std::string> inputs;   ///< what they do to small motions changes as hinges go on
  std::vector<std::string> outputs;  ///< what they show of small motions does
  std::vector<std::string> timed;    ///< outputs: it does as time goes on by itself
  std::vector<std::string> moving;   ///< outputs: their values at the state do not stay
};

/// \param names of the outputs as they were asked for (Ports::outputs)
EndsToCome ends_to_come(const Configuration& configuration, SmallMotions& motions, SampledLoads& sampled,
                        const std::vector<LinearInput>& inputs, const std::vector<LinearOutput>& outputs,
                        const std::vector<std::string>& names, const StatesToCome& states);

/// Loads that act and whose gain is that of an instant (ChangingLaw).
std::vector<std::string> changing_loads(const Configuration& configuration);

}  // namespace withy::study
