/// \file
/// Sensors of a scene, whoever wrote them, bound to a model.
#pragma once

#include <memory>
#include <span>

#include "withy/core/plugin/sensor.hpp"

namespace withy {

/// The sensor bound to a model, behind those before it.
/// \throws std::invalid_argument where it cannot be bound, says of its numbers what no table can hold (validate.hpp),
/// or asks for sections that the model's bodies have not; the text says which. std::bad_alloc; PluginError where a
/// library is refused.
std::shared_ptr<const BoundSensor> bind_sensor(const Sensor& sensor, const Model& model,
                                               std::span<const SensorNode> before);

}  // namespace withy
