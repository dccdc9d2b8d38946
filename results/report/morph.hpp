/// \file
/// A deforming surface as few shapes whose weights change over time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "withy/results/report/animation.hpp"

namespace withy {

/// displacement(vertex, moment) = sum of shape times weight.
struct Morph {
  Eigen::MatrixXd shapes;   ///< a column each: x, y, z of every vertex [m, body axes]
  Eigen::MatrixXd weights;  ///< a row each, a column a moment; the greatest of a row is 1
};

/// The fewest principal shapes of what a body's surface does that leave no vertex farther off than `tolerance` times
/// the greatest displacement; none where it does not deform. By the eigenvectors of the displacements' Gram matrix:
/// time grows with the square of the moments times the vertices, plus their cube.
Morph morph_of(const Animation& run, std::size_t body, double tolerance);

}  // namespace withy
