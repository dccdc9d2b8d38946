/// \file
/// Sparse stiffness and mass matrices as finite-element programs write them.
#pragma once

#include <Eigen/SparseCore>
#include <compare>
#include <filesystem>
#include <vector>

#include "mesh.hpp"

namespace withy::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// A row of a matrix: translation of a node along axis 0, 1 or 2.
struct Freedom {
  long node = 0;
  int axis = 0;
  auto operator<=>(const Freedom&) const = default;
};

/// A symmetric matrix, both triangles, with what its rows are.
struct NamedMatrix {
  std::vector<Freedom> rows;
  SparseMatrix values;
};

/// K [N/m] and M [kg] of a free mesh of solid elements: row 3 a + c is axis c of nodes[a].
struct Matrices {
  std::vector<long> nodes;  ///< numbers, ascending
  Matrix3X X;               ///< their places, 3×N [m]
  SparseMatrix K, M;
};

/// A matrix of CalculiX: `values` is a `.sti` or `.mas`, `freedoms` its `.dof`.
/// \throws InputError, also where freedoms are named twice, as of the solids CalculiX makes of beams and shells.
NamedMatrix read_calculix(const std::filesystem::path& values, const std::filesystem::path& freedoms);

/// A matrix of Abaqus (*MATRIX OUTPUT), FORMAT=MATRIX INPUT or COORDINATE, one triangle or both. COORDINATE names no
/// nodes: its rows are taken as three for each node of the mesh in ascending order.
/// \throws InputError
NamedMatrix read_abaqus(const std::filesystem::path& file, const Mesh& mesh);

/// Stiffness and mass in one order. \throws InputError where they do not have the same rows, a node has not three, or
/// none in the mesh.
Matrices combined(const NamedMatrix& K, const NamedMatrix& M, const Mesh& mesh);

/// The rows of a matrix in the order of Matrices; rows that it lacks are empty. \throws InputError where it has others.
SparseMatrix arranged(const NamedMatrix& matrix, const std::vector<long>& nodes);

}  // namespace withy::fem
