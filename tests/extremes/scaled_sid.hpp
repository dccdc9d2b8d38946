/// \file
/// Standard Input Data in other units.
#pragma once

#include "scaled_scene.hpp"
#include "withy/bodies/modal/sid.hpp"

namespace withy::extremes {

/// The data in the units of the gauge, modal coordinates taken for lengths: Φ has no unit, Me is in kg, Ke in N/m.
sid::Data scaled(sid::Data data, const Gauge& gauge);

}  // namespace withy::extremes
