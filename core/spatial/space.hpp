/// \file
/// The algebra of the sweeps, once for motion in a plane (Planar) and once in three dimensions (Spatial), with the same
/// names:
///   Position, Angular   a place [m] and a small rotation or angular velocity, in a plane a number
///   Twist               (angular; linear) velocity of a frame's origin in that frame's axes, or a wrench (moment;
///   force)
///                       about it: 1 + 2 numbers in the plane, 3 + 3 in space. An acceleration is the component-wise
///                       derivative of a twist in its own moving frame (Featherstone's spatial acceleration).
///     turning, turn, turn_row, turn_column    the part about the third axis (a revolute hinge's, once aligned)
///     sliding, slide, slide_row, slide_column the part along the first axis (a prismatic hinge's)
///   Frame               pose X_AB: axes and origin of B in A
///     to_child            twist of B from that of A, both on one rigid body; from_child: its inverse
///     to_parent           wrench about A from that about B: the transpose of to_child
///     shift_…             the same with parallel axes, B's origin at p in A
///   cross, cross_force  V × U of twists; V ×* F of a wrench, V ×* = −(V ×)ᵀ
///   Inertia, Matrix     symmetric and general maps of twists to wrenches; to_parent: Xᵀ M X with X = to_child
///     times_cross         M (V ×);   cross_transposed_times   (V ×)ᵀ M
#pragma once

#include "withy/core/spatial/planar.hpp"
#include "withy/core/spatial/spatial.hpp"
