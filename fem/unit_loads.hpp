/// \file
/// Geometric stiffness from unit loads: what K and M alone do not know. A mesh prestressed by a load has the stiffness
/// K + K_geo; both are linear in the load, so that twelve fields of force, ρ e_i and ρ X_j e_i, give every inertial
/// load and weight, and the forces and moments on the interfaces the rest (Banerjee & Dickens 1990). Reduced, −φ_kᵀ
/// K_geo φ_l is the work of the load on the second-order displacement Γ_kl.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reduce.hpp"

namespace withy::fem {

/// A load on the nodes, in this order: ρ e_i (i = x, y, z); ρ X_j e_i (j before i), X from the body's origin; then for
/// each interface its forces and, of a rigid section, its moments.
struct UnitLoad {
  std::string name;       ///< "acceleration x", "gradient x of y", "force x at TIP", "moment z at TIP"
  Eigen::VectorXd force;  ///< of size 1, 3N
  double factor = 1;      ///< that the deck has it times: it moves the mesh by 1e-5 of its extent
};

std::vector<UnitLoad> unit_loads(const Matrices& matrices, const Reduction& body, const ReductionOptions& options);

/// Writes decks of CalculiX into a folder, `unit-01-plus.inp`, `unit-01-minus.inp` …: a static step with the load, or
/// its opposite, on the mesh of `model` (an input deck), clamped at the root, then a perturbation step that stores K +
/// K_geo. `nodes` are those of Matrices. \throws InputError, std::system_error
void write_decks(const std::filesystem::path& folder, const std::filesystem::path& model,
                 const std::vector<long>& nodes, const std::vector<UnitLoad>& loads, const ReductionOptions& options);

/// Reads what CalculiX made of these decks. \throws InputError where a result is missing or of another mesh.
GeometricStiffness read_geometric_stiffness(const std::filesystem::path& folder, const Matrices& matrices,
                                            const Reduction& body, const std::vector<UnitLoad>& loads);

}  // namespace withy::fem
