/// \file
/// The outer faces of a mesh of solid elements, with the shapes of a reduced body's modes: how the body is drawn.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reduce.hpp"

namespace withy::fem {

/// Faces that no two elements share, by the elements' corners: edges of quadratic elements are drawn straight.
struct OuterFaces {
  std::vector<Eigen::Index> rows;                 ///< of its vertices, in Matrices::nodes, ascending
  std::vector<std::vector<std::uint32_t>> faces;  ///< three or four vertices each, counter-clockwise from outside
};

/// \throws InputError where the deck has no elements, elements that element_shape() does not know, or nodes that the
/// matrices have not: what() says which.
OuterFaces outer_faces(const Mesh& mesh, const Matrices& matrices);

/// Numbers of second-order shapes that a file takes, at most.
inline constexpr Eigen::Index most_second_order = 2'000'000;

/// The faces as VTK polygons in text, in the body's axes [m]. Vectors `mode_K` of their vertices are the modes,
/// `mode_K_L`, k ≤ l, the second-order displacements Γ_kl.
/// \param second 3N×n(n+1)/2 of the whole mesh, see second_order_displacements; without columns: not known
std::string surface_text(const Reduction& body, const OuterFaces& outer, const Eigen::MatrixXd& second);

}  // namespace withy::fem
