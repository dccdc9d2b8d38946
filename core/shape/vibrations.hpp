/// \file
/// Undamped vibrations of a stiffness matrix about a mass matrix.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace withy {

/// Columns v with vᵀ G v = 1 and their squared frequencies ω² = vᵀ K v [1/s²], increasing.
///
/// Eigenvalues are known to rounding of the greatest of them, which with many modes may be all of the least: those of n
/// polynomials on a clamped beam spread like n⁸, over 1e10 for 32. The quotients of the vectors are known to the square
/// of what these are off by.
struct Vibrations {
  Eigen::VectorXd squares;
  Eigen::MatrixXd vectors;

  /// How many of the first are motions without strain: their squares are rounding beside the greatest, or negative, as
  /// those of a K from a file may be.
  [[nodiscard]] Eigen::Index rigid() const;
};

/// Whether a squared frequency is rounding beside the greatest [1/s²].
bool is_rounding(double square, double greatest);

/// Groups of coordinates, increasing in each, such that K and G couple those of one group and no others beyond
/// rounding: what is apart in the data stays exactly apart in what is made of the groups' modes.
std::vector<std::vector<Eigen::Index>> coupled_coordinates(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G);

/// \param K symmetric [N/m]
/// \param G symmetric [kg]
/// \throws std::domain_error where G is not positive definite.
Vibrations vibrations(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G);

}  // namespace withy
