/// \file
/// Surfaces of triangles, and of simple solids, appended to others.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "withy/core/spatial/pose.hpp"

namespace withy {

/// A surface of triangles, vertices [m] in the axes of its body.
struct Surface {
  std::vector<Vector3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A section of a tube: an ellipse or a rectangle, half its widths [m] along the section's y and z.
struct Outline {
  bool rectangle = false;
  double y = 0, z = 0;
};

/// A tube along points.
struct Tube {
  std::vector<Vector3> line;
  std::vector<Outline> outlines;  ///< one at each point, or one for all
  std::vector<Vector3> y_axes;    ///< of the sections; or one, of the first, which the others follow without twist
};

/// A tube closed at both ends: rings of `sides` vertices, one at each point, first, then the two ends. A ring lies
/// about its point. \param sides of a rectangle 8
void add_tube(const Tube& tube, std::size_t sides, Surface& surface);
/// A ball about the origin.
void add_ball(double radius, Surface& surface);
/// An octahedron.
void add_bead(const Vector3& center, double radius, Surface& surface);
/// A box of edges [m] about the origin of a pose.
void add_box(const Vector3& edges, const Pose& pose, Surface& surface);
/// A sheet of a thickness [m], closed, about rows of points behind each other: above all points, then below. The side
/// that is above sees a row go to its left and the next row behind it.
void add_sheet(const std::vector<Vector3>& points, std::size_t columns, double thickness, Surface& surface);

}  // namespace withy
