/// \file
/// What a reduction kept and left out, for people to judge it by.
#pragma once

#include <array>
#include <vector>

#include "reduce.hpp"

namespace withy::fem {

struct Summary {
  double mass = 0;                    ///< [kg]
  Vector3 centre = Vector3::Zero();   ///< of mass, from the body's origin [m]
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre [kg m²]
  double mesh_difference = 0;         ///< of mass, Σ m r and inertia in the SID from sums over the mesh, relative
  double rigid_stiffness = 0;         ///< greatest stiffness against rigid motions, of the greatest in K
  Eigen::MatrixXd effective_mass;     ///< n×6: share of each mode in translation along and rotation about the axes
  std::array<double, 6> held = {};    ///< their sums: what is missing to 1 moves with higher modes, or not at all
};

/// The sums over the mesh are those of M with the six rigid motions; the SID's are read from its matrices.
Summary summary_of(const Matrices& matrices, const Reduction& body, const sid::Data& data);

}  // namespace withy::fem
