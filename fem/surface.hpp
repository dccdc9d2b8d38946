/// \file
/// The outer faces of a mesh, with the shapes of a reduced body's modes: how the body is drawn.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "reduce.hpp"

namespace withy::fem {

/// Faces that no two solids share, and those of shells, membranes and surfaces, each once, see element_faces().
struct OuterFaces {
  std::vector<Eigen::Index> rows;  ///< of its vertices, in Matrices::nodes, ascending
  /// Three or four vertices each; of solids counter-clockwise from outside. A face with nodes in the middles of its
  /// edges is several: of three corners four triangles, of four corners four triangles and what is between them.
  std::vector<std::vector<std::uint32_t>> polygons;
  std::size_t faces = 0;  ///< of elements
  std::string left_out;   ///< a type of elements without faces that are known, as of beams; empty where there is none
  [[nodiscard]] std::size_t triangles() const;  ///< that the polygons make
};

/// How faces with nodes in the middles of their edges are taken.
enum class FaceEdges { bent, straight };

/// \throws InputError where the deck has no elements that have faces, or nodes that the matrices have not: what() says
/// which.
OuterFaces outer_faces(const Mesh& mesh, const Matrices& matrices, FaceEdges edges = FaceEdges::bent);

/// Triangles of a body that a picture takes, at most: as read_mode_surface() of scenes.
inline constexpr std::size_t most_drawn_triangles = 100'000;

/// Numbers of second-order shapes that a file takes, at most.
inline constexpr Eigen::Index most_second_order = 2'000'000;

/// The faces as VTK polygons in text, in the body's axes [m]. Vectors `mode_K` of their vertices are the modes,
/// `mode_K_L`, k ≤ l, the second-order displacements Γ_kl.
/// \param second 3N×n(n+1)/2 of the whole mesh, see second_order_displacements; without columns: not known
std::string surface_text(const Reduction& body, const OuterFaces& outer, const Eigen::MatrixXd& second);

/// Whether a file is there that begins as surface_text() does.
bool is_surface(const std::filesystem::path& file);

}  // namespace withy::fem
