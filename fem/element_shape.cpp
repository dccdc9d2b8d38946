#include "element_shape.hpp"

#include <array>
#include <cmath>
#include <map>

#include "withy/core/spatial/jet.hpp"

namespace withy::fem {
namespace {

/// A value with its gradient.
using Real = DualNumber<double, 3>;
using Values = std::vector<Real>;
using Coordinates = std::array<Real, 3>;

/// Corners of [−1, 1]³, then the middles of its edges: of the lower face, of the upper, of the upright ones.
constexpr std::array<std::array<int, 3>, 20> brick_nodes = {{
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0},
}};

/// Linear, or quadratic of the serendipity family.
Values brick(const Coordinates& s, std::size_t nodes) {
  Values N;
  for (std::size_t a = 0; a < nodes; ++a) {
    Real product(nodes == 8 ? 0.125 : 1.0);
    Real sum(-2.0);
    int middles = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double at = brick_nodes[a][c];
      if (at == 0) {
        product *= 1.0 - s[c] * s[c];
        ++middles;
      } else {
        product *= 1.0 + at * s[c];
        sum += at * s[c];
      }
    }
    if (nodes == 20) product *= middles == 0 ? Real(0.125 * sum) : Real(0.25);
    N.push_back(product);
  }
  return N;
}

Values tetrahedron(const Coordinates& s, std::size_t nodes) {
  const std::array<Real, 4> L = {Real(1.0 - s[0] - s[1] - s[2]), s[0], s[1], s[2]};
  if (nodes == 4) return {L.begin(), L.end()};
  Values N;
  for (const Real& l : L) N.emplace_back(l * (2.0 * l - 1.0));
  constexpr std::array<std::array<std::size_t, 2>, 6> edges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  for (const auto& [i, j] : edges) N.emplace_back(4.0 * L[i] * L[j]);
  return N;
}

/// A triangle in the first two coordinates times [−1, 1] in the third.
Values wedge(const Coordinates& s, std::size_t nodes) {
  const std::array<Real, 3> L = {Real(1.0 - s[0] - s[1]), s[0], s[1]};
  const std::array<Real, 2> end = {Real(1.0 - s[2]), Real(1.0 + s[2])};
  const Real bulge = 1.0 - s[2] * s[2];
  Values N;
  for (const Real& e : end) {
    for (const Real& l : L) {
      const Real linear = 0.5 * l * e;
      N.emplace_back(nodes == 6 ? linear : Real(0.5 * l * ((2.0 * l - 1.0) * e - bulge)));
    }
  }
  if (nodes == 6) return N;
  for (const Real& e : end) {
    for (std::size_t i = 0; i < 3; ++i) N.emplace_back(2.0 * L[i] * L[(i + 1) % 3] * e);
  }
  for (const Real& l : L) N.emplace_back(l * bulge);
  return N;
}

struct Point {
  Vector3 at;
  double weight;
};

/// Gauss–Legendre on [−1, 1]: place and weight.
std::vector<std::array<double, 2>> gauss(int points) {
  if (points == 1) return {{0, 2}};
  if (points == 2) return {{-std::sqrt(1 / 3.0), 1}, {std::sqrt(1 / 3.0), 1}};
  return {{-std::sqrt(0.6), 5 / 9.0}, {0, 8 / 9.0}, {std::sqrt(0.6), 5 / 9.0}};
}

std::vector<Point> brick_points(int across) {
  std::vector<Point> points;
  for (const auto& z : gauss(across)) {
    for (const auto& y : gauss(across)) {
      for (const auto& x : gauss(across)) points.push_back({{x[0], y[0], z[0]}, x[1] * y[1] * z[1]});
    }
  }
  return points;
}

std::vector<Point> tetrahedron_points(int count) {
  if (count == 1) return {{Vector3::Constant(0.25), 1 / 6.0}};
  const double far = (5 - std::sqrt(5.0)) / 20, near = 1 - 3 * far;
  return {{{far, far, far}, 1 / 24.0},
          {{near, far, far}, 1 / 24.0},
          {{far, near, far}, 1 / 24.0},
          {{far, far, near}, 1 / 24.0}};
}

/// `triangle` and `up` points.
std::vector<Point> wedge_points(int triangle, int up) {
  std::vector<Point> points;
  for (const auto& z : gauss(up)) {
    if (triangle == 1) {
      points.push_back({{1 / 3.0, 1 / 3.0, z[0]}, 0.5 * z[1]});
    } else {
      for (const auto& [x, y] : {std::array{1 / 6.0, 1 / 6.0}, {2 / 3.0, 1 / 6.0}, {1 / 6.0, 2 / 3.0}})
        points.push_back({{x, y, z[0]}, z[1] / 6});
    }
  }
  return points;
}

ElementShape shape(Values (*functions)(const Coordinates&, std::size_t), std::size_t nodes,
                   const std::vector<Point>& points) {
  ElementShape s;
  s.nodes = static_cast<int>(nodes);
  for (const Point& p : points) {
    Coordinates at;
    for (std::size_t c = 0; c < 3; ++c) {
      at[c] = p.at[static_cast<Eigen::Index>(c)];
      at[c].derivatives()[c] = 1;
    }
    const Values N = functions(at, nodes);
    Matrix3X gradient(3, s.nodes);
    for (std::size_t a = 0; a < nodes; ++a)
      gradient.col(static_cast<Eigen::Index>(a)) = Eigen::Map<const Vector3>(N[a].derivatives().data());
    s.weights.push_back(p.weight);
    s.gradients.push_back(gradient);
  }
  return s;
}

}  // namespace

const ElementShape* element_shape(const std::string& type) {
  static const std::map<std::string, ElementShape> shapes = {
      {"C3D4", shape(tetrahedron, 4, tetrahedron_points(1))},
      {"C3D6", shape(wedge, 6, wedge_points(1, 2))},
      {"C3D8", shape(brick, 8, brick_points(2))},
      {"C3D10", shape(tetrahedron, 10, tetrahedron_points(4))},
      {"C3D15", shape(wedge, 15, wedge_points(3, 3))},
      {"C3D20", shape(brick, 20, brick_points(3))},
      {"C3D20R", shape(brick, 20, brick_points(2))},
  };
  const auto it = shapes.find(type);
  return it == shapes.end() ? nullptr : &it->second;
}

}  // namespace withy::fem
