/// \file
/// Checks of what a body or a hinge claims to be, whoever wrote it: done once, when it is made or a model is built.
#pragma once

#include <string>
#include <vector>

#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/motion.hpp"
#include "withy/core/plugin/rod.hpp"
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
/// The same of a body of `modes` modes that is cut: its section, curvature, stiffness and the mass beyond.
std::string find_fault(const BodyCut& cut, Eigen::Index modes);
/// What is wrong with a hinge near its reference, or empty: numbers of coordinates and rates that none has, a reference
/// or a motion that is not finite, R that is no rotation, or another motion than the kernel's that it says it is; H
/// that is not the derivative of its pose, a bias that is not that of H, and derivatives of both (motion_derivative)
/// that are none. These are compared with differences over steps of 1e-2 and less, to 1e-4 of their size, as
/// false_slope (false_slope.hpp) does: where differences do not tell, as at a kink, nothing is said. It is looked at at
/// two places beside the reference, on the other side where it cannot be at one, and nearer where it can be at neither.
/// Whatever the hinge throws comes out.
std::string find_fault(const Hinge& hinge);
/// What is wrong with a motion, or empty: a rate that is not the derivative of its coordinate, an acceleration that is
/// not that of its rate, or one that is not finite where the coordinate is. These are compared with differences at four
/// times until its end, of one without an end of the first second or until its last discontinuity, to 1e-4 of the
/// greatest, over steps that lead over no discontinuity. Where differences do not tell (false_slope.hpp), as of what is
/// faster than the shortest of them or rounds the time, nothing is said. One that locks is not looked at. Whatever the
/// motion throws comes out.
std::string find_fault(const Motion& motion);
/// What is wrong with the rod of a body, or empty: other modes, another mass or other deflections than the body's, a
/// length or wave number that is none, kinks that do not increase inside it, sections that are not finite or
/// of an inertia that none has, a root that is apart from what is next to it, and rotations and deflections that are
/// not the integrals of its strains. Integrals are compared with differences over steps of 1e-2 of 1/β and less, to
/// 1e-4 of the greatest; where these do not tell (false_slope.hpp), as at a kink, nothing is said.
std::string find_fault(const Rod& rod, const ModalShape& shape);
/// What is wrong with the numbers that a sensor says it gives, or empty: none at all, two of one name, a name or unit
/// that the head of a table cannot hold, as one with a comma.
std::string find_fault(const std::vector<SensorColumn>& columns);
/// What is wrong with the names of a load's continuous states, or empty: none, two alike, or one that the head of a
/// table cannot hold. States are kept by these names, and two of one name are not read back.
std::string state_names_fault(const std::vector<std::string>& names);

}  // namespace withy
