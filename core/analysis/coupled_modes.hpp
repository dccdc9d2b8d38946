/// \file
/// Modes of bodies together with what loads have of differential equations: controllers, actuators, filters.
#pragma once

#include <vector>

#include "withy/core/analysis/modes.hpp"

namespace withy {

/// natural_modes where loads have continuous states: the eigenvalues of the whole first-order form.
/// \throws std::domain_error as natural_modes.
std::vector<Mode> modes_with_states(const Tangents& tangents, const Held& held);

/// The left eigenvectors of A, a column for each of its eigenvalues.
Eigen::MatrixXcd left_vectors(const Eigen::MatrixXd& A, const Eigen::VectorXcd& values);
/// The greatest |w_i z_i| of the eigenvectors w, z of a first-order form, of a displacement with that of its rate:
/// index among so many displacements, then the states of loads.
Eigen::Index most_taking_part(const Eigen::VectorXcd& left, const Eigen::VectorXcd& right, Eigen::Index displacements);

/// Those that grow first, then in the order of the smaller |λ| of each pair.
void sort_modes(std::vector<Mode>& modes);

}  // namespace withy
