/// \file
/// What sensors ask of a state, found in passes over the bodies of a model.
#pragma once

#include <memory>

#include "withy/core/equations/applied_loads.hpp"
#include "withy/core/kinematics/sensed_plan.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy::equations {

/// The equations and their loads are those of the plan's model, and must outlive the result.
std::unique_ptr<SensedState> make_sensing(std::unique_ptr<const sensed::Plan> plan, const EquationsOfMotion& equations,
                                          const AppliedLoads& loads);

}  // namespace withy::equations
