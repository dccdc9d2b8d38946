/// \file
/// Checks of what a body or a hinge claims to be, whoever wrote it: done once, when it is made or a model is built.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/sensor.hpp"
#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// What is wrong with a shape, in a few words, or empty: numbers that are not finite, fields whose sizes do not agree
/// with the number of modes, Γ, Θ, K, D or an inertia not symmetric, a negative mass, D or an inertia not positive
/// semidefinite, modes without a name, with one that no table can hold, or with that of another. Symmetry and sign are
/// judged to 1e-10 of the greatest element: far above the rounding of any quadrature, far below an error of
/// formulation.
std::string find_fault(const ModalShape& shape);
/// The same of the motion of one point of a body with `modes` modes.
std::string find_fault(const PointExpansion& point, Eigen::Index modes);
/// What is wrong with a hinge near its reference, or empty: numbers of coordinates and rates that none has, or another
/// motion than the kernel's that it says it is; H that is not the derivative of its pose, a bias that is not that of H.
/// These are compared with differences over steps from 1e-2 to 1e-5, to 1e-4 of their size; one that agrees will do.
std::string find_fault(const Hinge& hinge);
/// What is wrong with the numbers that a sensor says it gives, or empty: none at all, two of one name, a name or unit
/// that the head of a table cannot hold, as one with a comma.
std::string find_fault(const std::vector<SensorColumn>& columns);

}  // namespace withy
