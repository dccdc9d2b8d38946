/// \file
/// Fields of modes as they are seen from a section that modes move and that something holds.
#pragma once

#include "withy/core/shape/modal_shape.hpp"

namespace withy {

/// A section of a body by which it is held: of the rotation that modes give it the part `held` is taken off the whole
/// body, as a hinge there does that leaves only the rest free.
struct HeldSection {
  PointExpansion at;
  Matrix3 held = Matrix3::Identity();

  /// Whether it changes nothing: modes do not turn the section, or nothing holds it from turning.
  [[nodiscard]] bool leaves_all() const;
  /// The motion of a point of the body relative to the section, to the second order: Rₛᵀ (r − rₛ) − X and Rₛᵀ R.
  /// \param point of the same body, in its frame
  [[nodiscard]] PointExpansion seen(const PointExpansion& point) const;
};

/// The mass matrix of the modes of a body that is held so.
Eigen::MatrixXd modal_mass(const ModalShape& shape, const HeldSection& section);

}  // namespace withy
