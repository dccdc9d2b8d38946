#include <Eigen/Geometry>
#include <algorithm>

#include "withy/core/tree/steps.hpp"

namespace withy::compilation {
namespace {

/// What hangs on each node: one list a node.
struct Dependents {
  std::vector<std::vector<std::size_t>> nodes, bodies;
  explicit Dependents(const PlacedTree& tree) : nodes(tree.nodes.size()), bodies(tree.nodes.size()) {
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      if (tree.nodes[i].parent >= 0) nodes[static_cast<std::size_t>(tree.nodes[i].parent)].push_back(i);
    }
    for (std::size_t b = 0; b < tree.places.size(); ++b) {
      if (tree.places[b].node >= 0) bodies[static_cast<std::size_t>(tree.places[b].node)].push_back(b);
    }
  }
};

/// Gives a node's frame a new place: X_AN of the old frame N in the new frame A.
void rebase(PlacedTree& tree, const Dependents& dependents, std::size_t index, const Pose& AN) {
  NodeSpec& n = tree.nodes[index];
  n.base = n.base.seen_from(AN);
  n.mass.move(AN);
  for (StationSpec& s : n.stations) s = {moved(s.at, AN), s.carried.seen_from(turned(AN.R))};
  n.rod_frame = AN * n.rod_frame;
  n.M = n.root_station < 0 ? AN * n.M : turned(AN.R) * n.M;
  const auto seen = [&](int station, const Pose& X) { return station < 0 ? AN * X : turned(AN.R) * X; };
  for (const std::size_t i : dependents.nodes[index]) {
    NodeSpec& child = tree.nodes[i];
    child.F = seen(child.parent_station, child.F);
  }
  for (const std::size_t b : dependents.bodies[index]) {
    BodyPlace& place = tree.places[b];
    place.pose = seen(place.station, place.pose);
  }
}

/// A rotation whose third column is z and, where given, whose first is x.
Matrix3 basis(const Vector3& z, const Vector3* x = nullptr) {
  Matrix3 Q;
  Q.col(2) = z;
  Q.col(0) = x != nullptr ? *x : z.unitOrthogonal();
  Q.col(1) = z.cross(Q.col(0));
  return Q;
}

/// Rotation of each node's frame at the reference configuration.
std::vector<Matrix3> reference_rotations(const NodeTree& tree) {
  std::vector<Matrix3> R;
  for (const NodeSpec& n : tree.nodes) {
    const Matrix3 F = n.parent < 0 ? n.F.R : Matrix3(R[static_cast<std::size_t>(n.parent)] * n.F.R);
    R.push_back(F * n.M.R.transpose());
  }
  return R;
}

/// Rotations agree to what unit quaternions in a file can give.
constexpr double angle_tolerance = 1e-12;

bool along(const Vector3& a, const Vector3& unit, double scale) {
  return a.cross(unit).norm() <= angle_tolerance * scale;
}
bool across(const Vector3& a, const Vector3& unit, double scale) {
  return std::abs(a.dot(unit)) <= angle_tolerance * scale;
}

}  // namespace

bool fields_in_plane(const PlacedPoint& point, const Vector3& n) {
  double phi = 0, psi = 0;
  for (Eigen::Index i = 0; i < point.modes(); ++i) {
    phi = std::max(phi, point.phi(i).cwiseAbs().maxCoeff());
    psi = std::max(psi, point.psi(i).cwiseAbs().maxCoeff());
  }
  const double linear = phi + psi;
  for (Eigen::Index i = 0; i < point.modes(); ++i) {
    if (!across(point.phi(i), n, linear) || !along(point.psi(i), n, linear)) return false;
    for (Eigen::Index j = 0; j < point.modes(); ++j) {
      if (!across(point.gamma(i, j), n, linear * linear) || !along(point.theta(i, j), n, linear * linear)) return false;
    }
  }
  return true;
}

std::optional<Vector3> plane_normal(const NodeTree& tree) {
  const std::vector<Matrix3> R = reference_rotations(tree);
  using enum HingeKernel::Kind;
  std::optional<Vector3> normal;
  for (std::size_t i = 0; i < tree.nodes.size() && !normal; ++i) {
    const NodeSpec& n = tree.nodes[i];
    if (n.kernel && n.kernel->kind == revolute) normal = R[i] * n.M.R * n.kernel->axis;
  }
  if (!normal) return {};
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const NodeSpec& n = tree.nodes[i];
    if (!n.kernel) return {};
    const Vector3 axis = R[i] * n.M.R * n.kernel->axis;
    switch (n.kernel->kind) {
      case weld:
        break;
      case revolute:
        if (!along(axis, *normal, 1)) return {};
        break;
      case prismatic:
        if (!across(axis, *normal, 1)) return {};
        break;
      default:
        return {};
    }
    const Vector3 in_node = R[i].transpose() * *normal;
    for (std::size_t k = 0; k < n.mass.size(); ++k) {
      if (!fields_in_plane(n.mass.point(k), in_node)) return {};
    }
    for (const Section& s : n.mass.sections()) {
      if (!fields_in_plane(s.at, in_node)) return {};
    }
    for (const StationSpec& s : n.stations) {
      if (!fields_in_plane(s.at, in_node)) return {};
    }
  }
  return normal;
}

Matrix3 basis_near_x(const Vector3& z) {
  Vector3 x = Vector3::UnitX() - z * z.x();
  if (x.norm() < 0.5) x = Vector3::UnitY() - z * z.y();
  x.normalize();
  return basis(z, &x);
}

void align(PlacedTree& tree) {
  using enum HingeKernel::Kind;
  const Vector3 normal = tree.plane.R.col(2);
  const std::vector<Matrix3> R = reference_rotations(tree);
  const Dependents dependents(tree);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    NodeSpec& n = tree.nodes[i];
    Matrix3 Q = Matrix3::Identity();
    if (tree.planar) {
      const Vector3 z = (R[i] * n.M.R).transpose() * normal;
      if (n.kernel->kind == prismatic) {
        Q = basis(z, &n.kernel->axis);
      } else {
        // As near to the frame's own axes as can be, so that a tree drawn in the plane stays as it is.
        Q = basis_near_x(z);
        if (n.kernel->kind == revolute) n.direction = n.kernel->axis.dot(z) > 0 ? 1 : -1;
      }
    } else if (n.kernel && n.kernel->kind == revolute) {
      if (n.kernel->axis != Vector3::UnitZ()) Q = basis(n.kernel->axis);
    } else if (n.kernel && n.kernel->kind == prismatic) {
      const Vector3 z = n.kernel->axis.unitOrthogonal();
      if (n.kernel->axis != Vector3::UnitX()) Q = basis(z, &n.kernel->axis);
    }
    n.F = n.F * turned(Q);
    n.M = n.M * turned(Q);
    if (n.root_station < 0) {
      const Pose to_hinge = n.M.inverse();
      rebase(tree, dependents, i, to_hinge);
      tree.nodes[i].M = Pose{};
    } else if (tree.planar) {
      // The body frame itself must lie in the plane: turn it about its own origin.
      const Vector3 z = R[i].transpose() * normal;
      rebase(tree, dependents, i, turned(basis_near_x(z).transpose()));
    }
  }
}

}  // namespace withy::compilation
