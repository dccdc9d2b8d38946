/// \file
/// When the events of a scene happen: the numbers that they watch.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/scene/check.hpp"

namespace withy {

/// A number that an event watches; nothing said: the event is at a time, after another one, or at a limit.
struct Watched {
  int element = -1;        ///< of State::y; −1: a sensor's number
  std::size_t column = 0;  ///< of the sensors' numbers, counted through
  std::string unit = {};   ///< SI; empty: a number without one
};

/// What the event watches among the coordinates and rates of hinges and the scene's outputs; nothing after a reported
/// error.
/// \param event checked by grammar::scene_members
std::optional<Watched> watched(const Model& model, const std::vector<SensorNode>& outputs, const Value& event,
                               const Checker& checker);

/// Reports events that come after one another in a circle: none of them can begin.
/// \param events checked by grammar::scene_members
void refuse_circles(const Value& events, const Checker& checker);

/// A sensor of how far the load that the event names under `limit` is from it; null after a reported error.
std::shared_ptr<const BoundSensor> limit_of(const Model& model, const Value& event, const Checker& checker);

}  // namespace withy
