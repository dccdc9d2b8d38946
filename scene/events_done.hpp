/// \file
/// What events have done up to a state, as `initial` and written states say it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// What a state knows of the events of its scene, by names.
struct EventsDone {
  std::vector<std::string> locked;                            ///< hinges
  std::vector<std::pair<std::string, std::string>> settings;  ///< of loads that are not as the scene states them
  /// Of each event that acts, its numbers by their names.
  std::vector<std::pair<std::string, std::vector<std::pair<std::string, double>>>> events;
};

/// Nothing where the model has no events that act.
std::optional<EventsDone> events_done(const Model& model, const State& state);

/// Reads `locked`, `settings` and `events` of a state's value, after its hinges. \returns false after reporting.
bool read_events_done(const Value& value, const Model& model, const Checker& checker, State& state);

}  // namespace withy
