/// \file
/// The inertia of a body whose modes are at rest.
#pragma once

#include "withy/core/shape/modal_shape.hpp"
#include "withy/core/tree/tree.hpp"

namespace withy {

/// Of particles and sections where they are undeformed, about the origin of the body frame.
RigidInertia rigid_inertia(const ModalShape& shape);

}  // namespace withy
