/// \file
/// Craig–Bampton reduction of a free mesh that is clamped at its root, and the Standard Input Data of the result.
/// R. R. Craig and M. C. C. Bampton, AIAA J. 6 (1968), 1313–1319.
#pragma once

#include <Eigen/Core>
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
  std::vector<sid::Node> nodes;             ///< root, interfaces, stations: order zero
  SparseMatrix node_mass;                   ///< N×N: M is this for each axis
  std::vector<double> fixed_frequencies;    ///< of the fixed-interface modes [Hz]
  std::vector<double> dropped_frequencies;  ///< of modes dropped [Hz]
  [[nodiscard]] double frequency(Eigen::Index k) const { return omega[k] / (2 * std::numbers::pi); }  ///< [Hz]
};

/// \throws InputError where the mesh is not free, not in one piece with its root, or has no such modes.
Reduction reduce(const Matrices& matrices, const ReductionOptions& options);

/// SID of the reduced body, without geometric stiffness, which K and M do not know: the first orders of Ct, Cr, Oe and
/// of the nodes' phi and psi are left out, and readers say so.
sid::Data sid_of(const Reduction& body);

}  // namespace withy::fem
