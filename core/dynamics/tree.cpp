#include "withy/core/dynamics/tree.hpp"

#include <Eigen/Geometry>

namespace withy {
namespace {

bool moves(const PointExpansion& e) {
  const auto nonzero = [](const auto& m) { return !m.isZero(0); };
  bool any = nonzero(e.phi) || nonzero(e.psi);
  for (std::size_t c = 0; c < 3; ++c) any = any || nonzero(e.gamma[c]) || nonzero(e.theta[c]);
  return any;
}

bool same(const PointExpansion& a, const PointExpansion& b) {
  bool equal = a.X == b.X && a.phi == b.phi && a.psi == b.psi;
  for (std::size_t c = 0; c < 3; ++c) equal = equal && a.gamma[c] == b.gamma[c] && a.theta[c] == b.theta[c];
  return equal;
}

Pose at(const Vector3& p) { return {Matrix3::Identity(), p}; }
Pose turned(const Matrix3& R) { return {R, Vector3::Zero()}; }

RigidInertia rigid_inertia(const ModalShape& shape) {
  RigidInertia I;
  for (const Particle& p : shape.particles) {
    I.mass += p.mass;
    I.moment += p.mass * p.at.X;
    I.inertia += p.mass * (p.at.X.squaredNorm() * Matrix3::Identity() - p.at.X * p.at.X.transpose());
  }
  for (const Section& s : shape.sections) I.inertia += s.inertia;
  return I;
}

/// Where something is fixed: a node's frame, or a station's section; node −1 is the world.
struct Place {
  int node = -1;
  int station = -1;
  Pose pose;
};

/// Turns the model's bodies into nodes.
class Merger {
 public:
  explicit Merger(const Model& model) : model_(model) {}

  Tree run() {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) place(b);
    return std::move(tree_);
  }

 private:
  void place(std::size_t b) {
    const HingeNode& h = model_.hinges()[b];
    const BodyNode& body = model_.bodies()[b];
    const Frame& root = body.frames[static_cast<std::size_t>(h.child_frame)];
    const bool flexible = body.body->shape().modes() > 0;
    const bool clamped = !moves(root.section);
    const auto kernel = h.hinge->kernel();
    const bool weld = kernel && kernel->kind == HingeKernel::Kind::weld;
    Place F{-1, -1, h.offset};
    if (h.parent >= 0) F = place_of(static_cast<std::size_t>(h.parent), h.parent_frame, h.offset);

    if (weld && clamped) {
      // The child's frame where it is fixed; X_FB of the body frame in the hinge frame.
      const Place at_frame{F.node, F.station, F.pose * (at(root.section.X) * root.pose).inverse()};
      if (!flexible) {
        fix_rigid(b, at_frame);
        return;
      }
      if (F.node >= 0 && F.station < 0 && node(F.node).modes == 0) {
        absorb_flexible(b, at_frame);
        return;
      }
    }
    new_node(b, F, root, clamped);
  }

  NodeSpec& node(int i) { return tree_.nodes[static_cast<std::size_t>(i)]; }

  /// Place of `offset` in a frame of a body.
  Place place_of(std::size_t b, int frame, const Pose& offset) {
    const Frame& f = model_.bodies()[b].frames[static_cast<std::size_t>(frame)];
    const Place& body = places_[b];
    const Pose in_section = f.pose * offset;
    // Where the hinge holds a section that the modes move, the body's own frame moves too: no place on it is rigid.
    const bool floats = body.node >= 0 && body.station < 0 && node(body.node).root_station >= 0;
    if (!moves(f.section) && !floats) return {body.node, body.station, body.pose * at(f.section.X) * in_section};
    // A flexible body's frame is always placed on its node's frame.
    return {body.node, station(body.node, moved(f.section, body.pose)), turned(body.pose.R) * in_section};
  }

  int station(int node_index, PointExpansion e) {
    std::vector<StationSpec>& stations = node(node_index).stations;
    for (std::size_t i = 0; i < stations.size(); ++i) {
      if (same(stations[i].at, e)) return static_cast<int>(i);
    }
    stations.push_back({std::move(e), {}});
    return static_cast<int>(stations.size()) - 1;
  }

  void fix_rigid(std::size_t b, const Place& where) {
    const std::string& name = model_.bodies()[b].name;
    places_.push_back(where);
    if (where.node < 0) {
      tree_.savings.push_back("'" + name + "' is fixed to the world: not modelled");
      return;
    }
    const RigidInertia I = rigid_inertia(model_.bodies()[b].body->shape()).seen_from(where.pose);
    NodeSpec& n = node(where.node);
    if (where.station < 0) {
      n.base += I;
      tree_.savings.push_back("'" + name + "' is rigidly part of '" + n.name + "'");
    } else {
      n.stations[static_cast<std::size_t>(where.station)].carried += I;
      tree_.savings.push_back("'" + name + "' is carried by a section of '" + n.name + "'");
    }
  }

  void take_modes(std::size_t b, NodeSpec& n, const Pose& where) {
    const BodyNode& body = model_.bodies()[b];
    const ModalShape& shape = body.body->shape();
    const Slot& slot = *model_.layout().body(body.name);
    n.body = static_cast<int>(b);
    n.modes = slot.speeds;
    n.mode_position = slot.position;
    n.mode_speed = slot.speed;
    n.stiffness = shape.stiffness;
    n.damping = shape.damping;
    for (const Particle& p : shape.particles) n.particles.push_back({p.mass, moved(p.at, where)});
    for (const Section& s : shape.sections) {
      n.sections.push_back({where.R * s.inertia * where.R.transpose(), moved(s.at, where)});
    }
  }

  void absorb_flexible(std::size_t b, const Place& where) {
    NodeSpec& n = node(where.node);
    const std::string rigid = n.name;
    n.name = model_.bodies()[b].name;
    take_modes(b, n, where.pose);
    places_.push_back(where);
    tree_.savings.push_back("'" + rigid + "' is rigidly part of '" + n.name + "'");
  }

  void new_node(std::size_t b, const Place& F, const Frame& root, bool clamped) {
    const HingeNode& h = model_.hinges()[b];
    const BodyNode& body = model_.bodies()[b];
    NodeSpec n;
    n.name = body.name;
    n.body = static_cast<int>(b);
    n.parent = F.node;
    n.parent_station = F.station;
    n.F = F.pose;
    n.hinge = h.hinge;
    n.kernel = h.hinge->kernel();
    n.slot = model_.layout().hinges[b];
    n.M = root.pose;
    if (body.body->shape().modes() > 0) {
      take_modes(b, n, Pose{});
    } else {
      n.base = rigid_inertia(body.body->shape());
      n.stiffness = n.damping = Eigen::MatrixXd::Zero(0, 0);
    }
    if (clamped) n.M = at(root.section.X) * root.pose;
    tree_.nodes.push_back(std::move(n));
    const int index = static_cast<int>(tree_.nodes.size()) - 1;
    if (!clamped) node(index).root_station = station(index, root.section);
    places_.push_back({index, -1, Pose{}});
  }

  const Model& model_;
  Tree tree_;
  std::vector<Place> places_;
};

/// Gives a node's frame a new place: X_AN of the old frame N in the new frame A.
void rebase(Tree& tree, std::size_t index, const Pose& AN) {
  NodeSpec& n = tree.nodes[index];
  const auto turn = [&](const Matrix3& I) { return Matrix3(AN.R * I * AN.R.transpose()); };
  n.base = n.base.seen_from(AN);
  for (Particle& p : n.particles) p.at = moved(p.at, AN);
  for (Section& s : n.sections) s = {turn(s.inertia), moved(s.at, AN)};
  for (StationSpec& s : n.stations) s = {moved(s.at, AN), s.carried.seen_from(turned(AN.R))};
  n.M = n.root_station < 0 ? AN * n.M : turned(AN.R) * n.M;
  for (NodeSpec& child : tree.nodes) {
    if (child.parent != static_cast<int>(index)) continue;
    child.F = child.parent_station < 0 ? AN * child.F : turned(AN.R) * child.F;
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
std::vector<Matrix3> reference_rotations(const Tree& tree) {
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

bool fields_in_plane(const PointExpansion& e, const Vector3& n) {
  bool good = true;
  const auto size = [](const auto& a, const auto& b) { return a.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff(); };
  if (e.phi.cols() == 0) return true;
  const double linear = size(e.phi, e.psi);
  for (Eigen::Index i = 0; i < e.phi.cols(); ++i) {
    good = good && across(e.phi.col(i), n, linear) && along(e.psi.col(i), n, linear);
    for (Eigen::Index j = 0; j < e.phi.cols(); ++j) {
      const Vector3 gamma(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j));
      const Vector3 theta(e.theta[0](i, j), e.theta[1](i, j), e.theta[2](i, j));
      good = good && across(gamma, n, linear * linear) && along(theta, n, linear * linear);
    }
  }
  return good;
}

/// The normal of the plane in which everything moves, world axes; nothing where there is none.
std::optional<Vector3> plane_normal(const Tree& tree) {
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
    for (const Particle& p : n.particles) {
      if (!fields_in_plane(p.at, in_node)) return {};
    }
    for (const Section& s : n.sections) {
      if (!fields_in_plane(s.at, in_node)) return {};
    }
    for (const StationSpec& s : n.stations) {
      if (!fields_in_plane(s.at, in_node)) return {};
    }
  }
  return normal;
}

/// Turns the hinge frames so that a revolute axis is the third axis and a prismatic axis the first; in a plane the
/// third axis is the normal. The node's frame becomes the hinge frame M where the hinge holds the node's frame.
void align(Tree& tree) {
  using enum HingeKernel::Kind;
  const Vector3 normal = tree.plane.R.col(2);
  std::vector<Matrix3> R = reference_rotations(tree);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    NodeSpec& n = tree.nodes[i];
    Matrix3 Q = Matrix3::Identity();
    if (tree.planar) {
      const Vector3 z = (R[i] * n.M.R).transpose() * normal;
      if (n.kernel->kind == prismatic) {
        Q = basis(z, &n.kernel->axis);
      } else {
        // As near to the frame's own axes as can be, so that a tree drawn in the plane stays as it is.
        Vector3 x = Vector3::UnitX() - z * z.x();
        if (x.norm() < 0.5) x = Vector3::UnitY() - z * z.y();
        x.normalize();
        Q = basis(z, &x);
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
      rebase(tree, i, to_hinge);
      tree.nodes[i].M = Pose{};
    } else if (tree.planar) {
      // The body frame itself must lie in the plane: turn it about its own origin.
      const Vector3 z = R[i].transpose() * normal;
      Vector3 x = Vector3::UnitX() - z * z.x();
      if (x.norm() < 0.5) x = Vector3::UnitY() - z * z.y();
      x.normalize();
      rebase(tree, i, turned(basis(z, &x).transpose()));
    }
  }
}

}  // namespace

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

Tree compile_tree(const Model& model) {
  Tree tree = Merger(model).run();
  if (const auto normal = plane_normal(tree)) {
    tree.planar = true;
    const Vector3 z = *normal;
    Vector3 x = Vector3::UnitX() - z * z.x();
    if (x.norm() < 0.5) x = Vector3::UnitY() - z * z.y();
    x.normalize();
    tree.plane.R = basis(z, &x);
    tree.savings.insert(tree.savings.begin(), "the motion is planar: three numbers a twist instead of six");
  }
  align(tree);
  if (tree.planar) {
    for (NodeSpec& n : tree.nodes) {
      if (n.parent < 0) n.F = tree.plane.inverse() * n.F;
    }
  }
  return tree;
}

}  // namespace withy
