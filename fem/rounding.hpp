/// \file
/// What of the modes' stiffness is rounding of the matrix and not strain of the mesh.
#pragma once

#include <Eigen/Core>

#include "matrices.hpp"

namespace withy::fem {

/// A free mesh has no stiffness where its parts move rigidly. Bending of a slender mesh has a share of 1e-7 of the
/// greatest stiffness and less, and its parts move all but rigidly in it: what numbers of few digits, or a support that
/// was left in the matrix, put there changes the lowest frequencies first.
struct Rounding {
  double unit = 0;                  ///< of an element of K, relative, as translations of the mesh show it
  Eigen::VectorXd frequency_error;  ///< of each mode, relative to its frequency; 1 where nothing of it is known
};

/// As of numbers with so many decimal digits.
int digits_of(double unit);
/// Of the elements of K, as translations of the mesh show it, relative.
double rounding_unit(const SparseMatrix& K);

/// By forces under the rigid motions that each node's neighbours make in a mode, which strain would not give, and a
/// bound for the rounding of the forces of strain.
/// \param modes 3N×n [m] of unit modal mass
/// \param omega [rad/s]
Rounding rounding_of(const Matrices& matrices, const Eigen::MatrixXd& modes, const Eigen::VectorXd& omega);

}  // namespace withy::fem
