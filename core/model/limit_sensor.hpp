/// \file
/// How far a load is beyond its limits.
#pragma once

#include <memory>

#include "withy/core/plugin/sensor.hpp"

namespace withy {

class Model;

/// One number of a load: the least of its margins to limits (LoadNumbers called `margin`, `rate_margin`, …) with its
/// sign changed, so that it is below zero within all limits, and passes zero from below where the first is reached.
/// Margins are of different units: only its sign has a meaning. Null where the load has no limits.
/// \param load index in Model::loads()
std::shared_ptr<const BoundSensor> limit_sensor(const Model& model, std::size_t load);

}  // namespace withy
