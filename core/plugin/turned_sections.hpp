/// \file
/// What slender bodies say of their sections' own axes and strains.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Sections with axes of their own, which may be turned about x along the body. A Body that knows of them is one of
/// these too, and so are the segments it is cut into; of any other body the axes are its own, and K is that of one
/// strain.
class TurnedSections {
 public:
  virtual ~TurnedSections() = default;
  /// The own axes of the section at x [m] as columns, in the axes of BodyCut's curvature and stiffness.
  [[nodiscard]] virtual Matrix3 section_axes(double x) const = 0;
  /// K as the sum of what single strains of the sections hold, about and along their own axes: each symmetric and
  /// positive semidefinite, as many and in the same order for each of a body's segments as for the body.
  [[nodiscard]] virtual std::vector<Eigen::MatrixXd> stiffness_by_strain() const = 0;
};

}  // namespace withy
