#include "withy/results/report/solids.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace withy {
namespace {

using Index = std::uint32_t;

Index next_vertex(const Surface& surface) { return static_cast<Index>(surface.vertices.size()); }

/// Two triangles, seen counter-clockwise from outside.
void add_quadrilateral(Index a, Index b, Index c, Index d, Surface& surface) {
  surface.triangles.push_back({a, b, c});
  surface.triangles.push_back({a, c, d});
}

/// The part of a vector across a direction, of unit length; any such direction where there is none.
Vector3 across(const Vector3& v, const Vector3& direction) {
  const Vector3 rest = v - v.dot(direction) * direction;
  if (rest.norm() > 1e-6) return rest.normalized();
  return direction.unitOrthogonal();
}

/// Where on an outline a ring has vertex j, over the half widths.
std::pair<double, double> ring_point(const Outline& outline, std::size_t j, std::size_t sides) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(sides);
  const double c = std::cos(angle), s = std::sin(angle);
  if (!outline.rectangle) return {c, s};
  // Corners and the middles of edges.
  const double far = std::max(std::abs(c), std::abs(s));
  return {c / far, s / far};
}

}  // namespace

void add_tube(const Tube& tube, std::size_t sides, Surface& surface) {
  const Index first = next_vertex(surface);
  const auto n = static_cast<Index>(sides);
  const std::vector<Vector3>& line = tube.line;
  Vector3 side = tube.y_axes.front();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Outline& outline = tube.outlines[tube.outlines.size() > 1 ? k : 0];
    const Vector3 chord = line[std::min(k + 1, line.size() - 1)] - line[k > 0 ? k - 1 : 0];
    const Vector3 along = chord.norm() > 0 ? Vector3(chord.normalized()) : Vector3(Vector3::UnitX());
    side = across(tube.y_axes.size() > 1 ? tube.y_axes[k] : side, along);
    const Vector3 other = along.cross(side);
    for (std::size_t j = 0; j < sides; ++j) {
      const auto [y, z] = ring_point(outline, j, sides);
      surface.vertices.push_back(line[k] + y * outline.y * side + z * outline.z * other);
    }
  }
  const Index begin = next_vertex(surface), end = begin + 1, last = begin - n;
  surface.vertices.push_back(line.front());
  surface.vertices.push_back(line.back());
  for (Index ring = first; ring < last; ring += n)
    for (Index j = 0; j < n; ++j)
      add_quadrilateral(ring + j, ring + (j + 1) % n, ring + n + (j + 1) % n, ring + n + j, surface);
  for (Index j = 0; j < n; ++j) {
    surface.triangles.push_back({begin, first + (j + 1) % n, first + j});
    surface.triangles.push_back({end, last + j, last + (j + 1) % n});
  }
}

void add_ball(double radius, Surface& surface) {
  // A tube along z whose rings are circles of latitude.
  constexpr std::size_t rings = 16;
  Tube tube{{}, {}, {Vector3::UnitX()}};
  for (std::size_t k = 0; k <= rings; ++k) {
    const double angle = std::numbers::pi * static_cast<double>(k) / rings;
    const double r = radius * std::sin(angle);
    tube.line.emplace_back(0, 0, -radius * std::cos(angle));
    tube.outlines.push_back({false, r, r});
  }
  add_tube(tube, 2 * rings, surface);
}

void add_bead(const Vector3& center, double radius, Surface& surface) {
  const Index x = next_vertex(surface), y = x + 2, z = x + 4;
  for (int i = 0; i < 3; ++i)
    for (const double sign : {1.0, -1.0}) surface.vertices.push_back(center + sign * radius * Vector3::Unit(i));
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 2; ++j)
      for (Index k = 0; k < 2; ++k) {
        const bool mirrored = (i + j + k) % 2 == 1;
        surface.triangles.push_back({x + i, mirrored ? z + k : y + j, mirrored ? y + j : z + k});
      }
}

void add_box(const Vector3& edges, const Pose& pose, Surface& surface) {
  const Index v = next_vertex(surface);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 signs(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
    surface.vertices.push_back(pose.p + pose.R * edges.cwiseProduct(signs));
  }
  static constexpr Index faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) add_quadrilateral(v + f[0], v + f[1], v + f[2], v + f[3], surface);
}

void add_sheet(const std::vector<Vector3>& points, std::size_t columns, double thickness, Surface& surface) {
  const Index v = next_vertex(surface), under = static_cast<Index>(points.size());
  const auto n = static_cast<Index>(columns), rows = under / n;
  const auto normal = [&](Index row, Index k) -> Vector3 {
    const auto at = [&](Index r, Index c) -> const Vector3& { return points[r * n + c]; };
    const Vector3 along = at(std::min(row + 1, rows - 1), k) - at(row > 0 ? row - 1 : 0, k);
    const Vector3 across = at(row, std::min(k + 1, n - 1)) - at(row, k > 0 ? k - 1 : 0);
    return across.cross(along).stableNormalized();
  };
  for (const double side : {0.5, -0.5})
    for (Index row = 0; row < rows; ++row)
      for (Index k = 0; k < n; ++k) surface.vertices.push_back(points[row * n + k] + side * thickness * normal(row, k));
  std::vector<Index> rim;  // seen from above, counter-clockwise
  for (Index k = 0; k + 1 < n; ++k) rim.push_back(v + k);
  for (Index row = 0; row + 1 < rows; ++row) rim.push_back(v + row * n + n - 1);
  for (Index k = n - 1; k > 0; --k) rim.push_back(v + (rows - 1) * n + k);
  for (Index row = rows - 1; row > 0; --row) rim.push_back(v + row * n);
  for (Index row = 0; row + 1 < rows; ++row)
    for (Index k = 0; k + 1 < n; ++k) {
      const Index a = v + row * n + k, b = a + n;
      add_quadrilateral(a, a + 1, b + 1, b, surface);
      add_quadrilateral(under + a, under + b, under + b + 1, under + a + 1, surface);
    }
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Index a = rim[i], b = rim[(i + 1) % rim.size()];
    add_quadrilateral(a, under + a, under + b, b, surface);
  }
}

}  // namespace withy
