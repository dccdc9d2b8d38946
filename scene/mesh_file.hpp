/// \file
/// Surfaces of triangles, from the files that CAD programs write, and those of bodies that bend.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// Vertices in the length unit of the file; each triangle names three of them, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Triangles that a page of a run still turns smoothly.
inline constexpr std::size_t most_triangles = 100'000;

/// Reads STL, binary or text, or Wavefront OBJ, by the end of the file's name. Equal vertices become one; polygons of
/// an OBJ become fans. Materials, textures and normals are left.
/// \throws std::domain_error saying what is wrong with the file, and in text on which line.
TriangleMesh read_mesh(const std::filesystem::path& file);

/// The surface of a body with n modes: its vertices [m, body axes] move by Φ q + ½ qᵀ Γ q.
struct ModeSurface {
  TriangleMesh mesh;
  Eigen::MatrixXf first;   ///< 3V×n, Φ of the V vertices below each other
  Eigen::MatrixXf second;  ///< 3V×n(n+1)/2, Γ_kl of the pairs k ≤ l, k outermost; without columns where not known
};

/// Reads what `withy import` writes: VTK polygons in text (.vtk) whose vertices have vectors named mode_K, for all n
/// modes, and mode_K_L, for all pairs or none, in any order.
/// \throws std::domain_error saying what is wrong with the file, and on which line.
ModeSurface read_mode_surface(const std::filesystem::path& file);

}  // namespace withy
