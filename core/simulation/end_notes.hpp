/// \file
/// What the message of a run tells of its course.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/integrator.hpp"

namespace withy {

/// Times [s] at which steps were rejected again and again, in sentences.
std::string note_on_jumps(const Model& model, const std::vector<double>& times);
/// The events that were to do something and have not, in a sentence; empty where there are none.
std::string note_on_missed_events(const Model& model, const State& end);
/// Of steps that are given and too long for what acts, where the balance of energy does not show it; empty where there
/// are none. \param scale greatest energy of the run [J]
std::string note_on_given_steps(const Stepper& stepper, double scale);
/// The event whose impulses have taken most energy, in a sentence: of a latch at high speed. Empty where none has.
std::string note_on_impulses(const Model& model, const State& end);

}  // namespace withy
