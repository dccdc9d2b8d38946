#include "withy/core/tree/tree.hpp"

#include "withy/core/tree/steps.hpp"

namespace withy {

RigidInertia RigidInertia::seen_from(const Pose& AB) const {
  const auto steiner = [](const Vector3& a, const Vector3& b) {
    return Matrix3(2 * a.dot(b) * Matrix3::Identity() - a * b.transpose() - b * a.transpose());
  };
  const Vector3 turned_moment = AB.R * moment;
  RigidInertia I;
  I.mass = mass;
  I.moment = turned_moment + mass * AB.p;
  I.inertia = AB.R * inertia * AB.R.transpose() + steiner(turned_moment, AB.p) + 0.5 * mass * steiner(AB.p, AB.p);
  return I;
}

RigidInertia& RigidInertia::operator+=(const RigidInertia& other) {
  mass += other.mass;
  moment += other.moment;
  inertia += other.inertia;
  return *this;
}

PointExpansion moved(const PointExpansion& e, const Pose& AB) {
  PointExpansion m = e;
  m.X = AB.p + AB.R * e.X;
  m.phi = AB.R * e.phi;
  m.psi = AB.R * e.psi;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    m.gamma[k] = AB.R(c, 0) * e.gamma[0] + AB.R(c, 1) * e.gamma[1] + AB.R(c, 2) * e.gamma[2];
    m.theta[k] = AB.R(c, 0) * e.theta[0] + AB.R(c, 1) * e.theta[1] + AB.R(c, 2) * e.theta[2];
  }
  return m;
}

PointExpansion relative_to(const PointExpansion& e, const PointExpansion& root, const Pose& M) {
  // With r the point and s, exp(θ) the root section: exp(−θ̂)(r − s) and exp(−θ̂) exp(χ̂), χ the point's section, to
  // second order; then the constant pose of M in the root section.
  const Eigen::Index n = e.phi.cols();
  PointExpansion a = PointExpansion::rigid(e.X - root.X, n);
  const auto component = [](const std::array<Eigen::MatrixXd, 3>& m, Eigen::Index i, Eigen::Index j) {
    return Vector3(m[0](i, j), m[1](i, j), m[2](i, j));
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3 p = root.psi.col(i);
    a.phi.col(i) = e.phi.col(i) - root.phi.col(i) - p.cross(a.X);
    a.psi.col(i) = e.psi.col(i) - p;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const Vector3 pi = root.psi.col(i), pj = root.psi.col(j);
      const Vector3 di = e.phi.col(i) - root.phi.col(i), dj = e.phi.col(j) - root.phi.col(j);
      const Vector3 theta = component(root.theta, i, j);
      const Vector3 gamma = component(e.gamma, i, j) - component(root.gamma, i, j) - pi.cross(dj) - pj.cross(di) -
                            theta.cross(a.X) + 0.5 * (pi.cross(pj.cross(a.X)) + pj.cross(pi.cross(a.X)));
      // log(exp(−θ̂) exp(χ̂)) = χ − θ − ½ θ × χ + …
      const Vector3 ci = e.psi.col(i), cj = e.psi.col(j);
      const Vector3 twist = component(e.theta, i, j) - theta - 0.5 * (pi.cross(cj) + pj.cross(ci));
      for (std::size_t c = 0; c < 3; ++c) {
        a.gamma[c](i, j) = gamma[static_cast<Eigen::Index>(c)];
        a.theta[c](i, j) = twist[static_cast<Eigen::Index>(c)];
      }
    }
  }
  return moved(a, M.inverse());
}

PlacedTree compile_placed_tree(const Model& model, bool planar) {
  PlacedTree tree = compilation::merge(model);
  if (const auto normal = planar ? compilation::plane_normal(tree) : std::nullopt) {
    tree.planar = true;
    tree.plane.R = compilation::basis_near_x(*normal);
    tree.savings.insert(tree.savings.begin(), "the motion is planar: three velocity components instead of six");
  }
  compilation::align(tree);
  if (tree.planar) {
    for (NodeSpec& n : tree.nodes) {
      if (n.parent < 0) n.F = tree.plane.inverse() * n.F;
    }
  }
  return tree;
}

NodeTree compile_tree(const Model& model) { return compile_placed_tree(model); }

}  // namespace withy
