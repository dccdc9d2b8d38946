/// \file
/// What the message of a run tells of its course.
#pragma once

#include <string>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Times [s] at which steps were rejected again and again, in sentences.
std::string note_on_jumps(const Model& model, const std::vector<double>& times);
/// The events that were to do something and have not, in a sentence; empty where there are none.
std::string note_on_missed_events(const Model& model, const State& end);
/// The event whose impulses have taken most energy, in a sentence: of a latch at high speed. Empty where none has.
std::string note_on_impulses(const Model& model, const State& end);

}  // namespace withy
