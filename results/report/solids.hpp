/// \file
/// Surfaces of simple solids, appended to others.
#pragma once

#include <vector>

#include "withy/results/report/animation.hpp"

namespace withy {

/// A tube of a radius [m] along points, closed at both ends: rings of `sides` vertices, one at each point, first, then
/// the two ends. Where the line is straight it lies about it; `side` is where the first vertex of a ring is.
void add_tube(const std::vector<Vector3>& line, double radius, std::size_t sides, Vector3 side, Surface& surface);
/// An octahedron.
void add_bead(const Vector3& center, double radius, Surface& surface);
/// A box of edges [m] about the origin of a pose.
void add_box(const Vector3& edges, const Pose& pose, Surface& surface);
/// A sheet: rows of points behind each other.
void add_sheet(const std::vector<Vector3>& points, std::size_t columns, Surface& surface);

}  // namespace withy
