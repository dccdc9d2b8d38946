/// \file
/// Interface nodes as a section.
#pragma once

#include <Eigen/Dense>

#include "matrices.hpp"

namespace withy::fem {

struct Section {
  std::vector<Eigen::Index> rows;  ///< indices of the nodes in Matrices::nodes
  Vector3 centre;                  ///< mean of their places [m]
  Matrix3X arms;                   ///< their places from the centre [m]

  /// Whether rotations mean something: three nodes or more that are not in a line.
  [[nodiscard]] bool rigid() const {
    return Eigen::SelfAdjointEigenSolver<Matrix3>(spread()).eigenvalues()[1] > 1e-12 * spread().trace();
  }
  /// Σ r rᵀ
  [[nodiscard]] Matrix3 spread() const { return arms * arms.transpose(); }
};

/// \throws InputError where a node is not in the matrices.
Section section_of(const std::vector<long>& nodes, const Matrices& matrices);

}  // namespace withy::fem
