/// \file
/// Rates that an integrator leaves behind of hinges that have come to rest.
#pragma once

#include "withy/core/analysis/steady_state.hpp"

namespace withy::study {

/// The state with those hinges at rest that are not held, that stiffness or weight pulls somewhere, and whose rates are
/// what an integrator goes to and fro with about rest: below 1e-6 rad/s or m/s, and in the time that they have of
/// themselves (√(m/k), or g/k where damping is more than that) they lead no farther than `resolved` or a billionth of
/// the coordinates. Of a hinge that nothing pulls no rate is too small to be one. \param resolved what the coordinates
/// are known to [rad, m]: the absolute tolerance of what made the state; 0: nothing \throws std::domain_error as
/// TangentDynamics::tangents
State without_creep(const TangentDynamics& dynamics, State state, const Held& held, double resolved);

}  // namespace withy::study
