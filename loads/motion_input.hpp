/// \file
/// The motion that a host sets between the steps of a simulation.
#pragma once

#include "withy/core/plugin/registry.hpp"

namespace withy {

void enroll_motion_input(Enrollment& enrollment);

}  // namespace withy
