#include "withy/core/tree/invariants.hpp"

#include <Eigen/Eigenvalues>

namespace withy {
namespace {

/// A piece of mass: its first moment is weight·origin·X, its second weight·X Xᵀ. A particle has origin 1; a rigid body
/// at a section is one particle at its centre of mass and three pieces of origin 0 along the principal axes of its
/// central second moment ½ tr(J) 1 − J, with weights that may be negative (a rod's twist has inertia about x alone).
struct Piece {
  double weight;
  double origin;
  PointExpansion at;
};

Vector3 component(const std::array<Eigen::MatrixXd, 3>& m, Eigen::Index i, Eigen::Index j) {
  return {m[0](i, j), m[1](i, j), m[2](i, j)};
}

/// origin·r(q) + R(q) e to second order.
PointExpansion attached(const PointExpansion& s, double origin, const Vector3& e) {
  PointExpansion a = s;
  a.X = origin * s.X + e;
  for (Eigen::Index i = 0; i < s.phi.cols(); ++i) {
    const Vector3 pi = s.psi.col(i);
    a.phi.col(i) = origin * s.phi.col(i) + pi.cross(e);
    for (Eigen::Index j = 0; j < s.phi.cols(); ++j) {
      const Vector3 pj = s.psi.col(j);
      const Vector3 g = origin * component(s.gamma, i, j) + component(s.theta, i, j).cross(e) +
                        0.5 * (pi.cross(pj.cross(e)) + pj.cross(pi.cross(e)));
      for (std::size_t c = 0; c < 3; ++c) a.gamma[c](i, j) = g[static_cast<Eigen::Index>(c)];
    }
  }
  return a;
}

void add_rotary(std::vector<Piece>& pieces, const PointExpansion& section, const Matrix3& inertia) {
  if (inertia.isZero(0)) return;
  const Matrix3 second = 0.5 * inertia.trace() * Matrix3::Identity() - inertia;
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(second);
  for (Eigen::Index k = 0; k < 3; ++k) {
    pieces.push_back({eigen.eigenvalues()[k], 0.0, attached(section, 0.0, eigen.eigenvectors().col(k))});
  }
}

std::vector<Piece> pieces_of(const NodeSpec& node) {
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k < node.mass.size(); ++k) pieces.push_back({node.mass.mass(k), 1.0, node.mass.at(k)});
  for (const Section& s : node.mass.sections()) add_rotary(pieces, s.at, s.inertia);
  for (const StationSpec& s : node.stations) {
    const RigidInertia& c = s.carried;
    Vector3 center = Vector3::Zero();
    if (c.mass != 0) {
      center = c.moment / c.mass;
      pieces.push_back({c.mass, 1.0, attached(s.at, 1.0, center)});
    }
    const RigidInertia central = c.seen_from({Matrix3::Identity(), -center});
    add_rotary(pieces, s.at, central.inertia);
  }
  return pieces;
}

Matrix3 product(const Vector3& a, const Vector3& b) {
  return 2 * a.dot(b) * Matrix3::Identity() - a * b.transpose() - b * a.transpose();
}

Vector6 wrench(const Vector3& moment, const Vector3& force) {
  Vector6 w;
  w << moment, force;
  return w;
}

}  // namespace

Invariants::Invariants(const NodeSpec& node, StrainOrder order) {
  const NodeSpec given = rooted(in_strain_order(node, order));
  const auto n = static_cast<Eigen::Index>(given.modes);
  const auto count = static_cast<std::size_t>(n);
  I0 = given.base;
  I1.assign(count, RigidInertia{});
  I2.assign(count * count, RigidInertia{});
  C0 = Eigen::MatrixXd::Zero(6, n);
  C1.assign(count, Eigen::MatrixXd::Zero(6, n));
  G0 = Eigen::MatrixXd::Zero(n, n);
  for (const Piece& piece : pieces_of(given)) {
    const double w = piece.weight;
    const double o = piece.origin;
    const Vector3& X = piece.at.X;
    I0.mass += w * o * o;
    I0.moment += w * o * X;
    I0.inertia += 0.5 * w * product(X, X);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vector3 pk = piece.at.phi.col(k);
      RigidInertia& first = I1[static_cast<std::size_t>(k)];
      first.moment += w * o * pk;
      first.inertia += w * product(X, pk);
      C0.col(k) += w * wrench(X.cross(pk), o * pk);
      for (Eigen::Index l = 0; l < n; ++l) {
        const Vector3 pl = piece.at.phi.col(l);
        const Vector3 g = component(piece.at.gamma, k, l);
        RigidInertia& second = I2[static_cast<std::size_t>(k * n + l)];
        second.moment += w * o * g;
        second.inertia += w * (product(X, g) + product(pk, pl));
        C1[static_cast<std::size_t>(k)].col(l) += w * wrench(pk.cross(pl) + X.cross(g), o * g);
        G0(k, l) += w * pk.dot(pl);
      }
    }
  }
}

std::vector<Eigen::MatrixXd> modal_mass_slopes(const NodeSpec& node, StrainOrder order) {
  const auto n = static_cast<Eigen::Index>(node.modes);
  std::vector<Eigen::MatrixXd> slopes(node.modes, Eigen::MatrixXd::Zero(n, n));
  for (const Piece& piece : pieces_of(rooted(in_strain_order(node, order)))) {
    for (Eigen::Index k = 0; k < n; ++k) {
      Matrix3X gamma(3, n);  // Γ_k
      for (Eigen::Index c = 0; c < 3; ++c) gamma.row(c) = piece.at.gamma[static_cast<std::size_t>(c)].row(k);
      const Eigen::MatrixXd half = piece.weight * gamma.transpose().lazyProduct(piece.at.phi);
      slopes[static_cast<std::size_t>(k)] += half + half.transpose();
    }
  }
  return slopes;
}

NodeSpec in_strain_order(NodeSpec node, StrainOrder order) {
  if (order != StrainOrder::linear) return node;
  const auto strip = [](PointExpansion& e) {
    for (std::size_t c = 0; c < 3; ++c) {
      e.gamma[c].setZero();
      e.theta[c].setZero();
    }
  };
  node.mass.make_linear();
  for (StationSpec& s : node.stations) strip(s.at);
  return node;
}

NodeSpec rooted(NodeSpec node) {
  if (node.root_station < 0) return node;
  const PointExpansion root = node.stations[static_cast<std::size_t>(node.root_station)].at;
  const Pose M = node.M;
  const Matrix3 turn = M.R.transpose();
  auto about_hinge = std::make_shared<ModalShape>();
  for (std::size_t k = 0; k < node.mass.size(); ++k)
    about_hinge->particles.push_back({node.mass.mass(k), relative_to(node.mass.at(k), root, M)});
  for (const Section& s : node.mass.sections())
    about_hinge->sections.push_back({turn * s.inertia * turn.transpose(), relative_to(s.at, root, M)});
  node.mass = PlacedMass(std::move(about_hinge));
  for (StationSpec& s : node.stations) {
    s = {relative_to(s.at, root, M), s.carried.seen_from({turn, Vector3::Zero()})};
  }
  // A node held by a moving section has no mass fixed to its frame: flexible bodies are absorbed at clamped roots only.
  node.root_station = -1;
  node.M = Pose{};
  return node;
}

}  // namespace withy
