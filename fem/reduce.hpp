/// \file
/// Craig–Bampton reduction of a free mesh that is clamped at its root, and the Standard Input Data of the result.
/// R. R. Craig and M. C. C. Bampton, AIAA J. 6 (1968), 1313–1319.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "matrices.hpp"
#include "withy/bodies/modal/sid.hpp"

namespace withy::fem {

/// Nodes that a hinge or a load of the body attaches to.
struct Interface {
  std::string name;         ///< of the SID node
  std::vector<long> nodes;  ///< one, with its three translations, or three or more, not in a line, as one rigid section
};

struct ReductionOptions {
  std::vector<long> root;             ///< nodes that are clamped, three or more, not in a line
  std::vector<Interface> interfaces;  ///< each with constraint modes; no node in two of them
  std::vector<Interface> stations;    ///< nodes to follow, one each, without modes of their own
  int modes = 10;                     ///< number of fixed-interface normal modes
  double highest = 0;                 ///< [Hz]: modes of the reduced body above are dropped; 0: none
};

/// The reduced body: modes with unit modal mass by rising frequency, fields on the mesh. Places are from the centre of
/// the root's nodes, which is the body's origin; axes are the mesh's.
struct Reduction {
  Vector3 origin;                           ///< in the mesh's frame [m]
  Matrix3X X;                               ///< of the mesh's nodes, 3×N [m]
  std::vector<Eigen::Index> free;           ///< rows of K and M that are not clamped
  Eigen::MatrixXd modes;                    ///< 3N×n [m]
  Eigen::VectorXd omega;                    ///< [rad/s]
  Eigen::VectorXd frequency_errors;         ///< of each mode by rounding of the stiffness, relative: below 0.01
  std::vector<sid::Node> nodes;             ///< root, interfaces, stations: order zero
  SparseMatrix node_mass;                   ///< N×N: M is this for each axis
  std::vector<double> fixed_frequencies;    ///< of the fixed-interface modes [Hz]
  std::vector<double> dropped_frequencies;  ///< of modes dropped [Hz]
  /// Static displacements of the clamped mesh under unit loads, 3N×loads: forces M e_c (c = x, y, z) and M X_i e_c
  /// (3 + 3 i + c), what 12 inertial loads are sums of; then for each coordinate of an interface, three forces and, of
  /// a rigid section, three moments; then three forces at each station. In the order of `nodes`, without the base.
  Eigen::MatrixXd loaded;
  /// Static displacements of the clamped mesh, its interfaces rigid, under forces: 3N×m of 3N×m.
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& forces)> statics;
  Eigen::MatrixXd held;  ///< K loaded less what loads the mesh itself: forces that act through interfaces and the root
  /// Second-order displacements in the direction of each unit load, f · Γ_kl [load's work/mode²], n×n each; empty where
  /// they are not known.
  std::vector<Eigen::MatrixXd> second_order;
  [[nodiscard]] double frequency(Eigen::Index k) const { return omega[k] / (2 * std::numbers::pi); }  ///< [Hz]
};

constexpr Eigen::Index inertial_loads = 12;

/// All but the second order. \throws InputError where the mesh is not free, not in one piece with its root, has no such
/// modes, or its stiffness has too few digits for their frequencies.
Reduction reduce(const Matrices& matrices, const ReductionOptions& options);

/// Adds the second order: Γ_kl is what leaves strains linear in the modal coordinates, so that with Green's strain
///   δᵀ K Γ_kl = −∫ σ(δ) : ∇φ_kᵀ ∇φ_l dV   for every displacement δ,
/// and f · Γ_kl = −G(u_f; φ_k, φ_l) with the stress of u_f = K⁻¹ f: the geometric stiffness of unit loads of
/// A. K. Banerjee and J. M. Dickens, J. Guid. Control Dyn. 13 (1990), 221–227. Rigid sections turn by exp(θ̂).
/// Returns by how much the stresses' forces miss those of K, relative.
/// \throws InputError where the deck does not tell the stresses: what() says why; `body` is then as it was.
double add_second_order(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options, Reduction& body);

/// Γ_kl itself, on the whole mesh: 3N×n(n+1)/2, pairs k ≤ l, k outermost [m/mode²]. add_second_order has been called.
Eigen::MatrixXd second_order_displacements(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options,
                                           const Reduction& body);

/// SID of the reduced body. Without the second order the first orders of Ct, Cr, Oe and of the nodes' phi and psi are
/// left out, and readers say so.
sid::Data sid_of(const Reduction& body);

}  // namespace withy::fem
