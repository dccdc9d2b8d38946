/// \file
/// Motions shaped so that given modes do not ring after them.
#pragma once

#include "withy/core/plugin/registry.hpp"

namespace withy {

void enroll_shaped_motion(Enrollment& enrollment);

}  // namespace withy
