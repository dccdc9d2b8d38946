#include "withy/core/reference/first_order_energy.hpp"

#include <Eigen/Eigenvalues>

#include "withy/core/reference/reference_tree.hpp"
#include "withy/core/spatial/jet.hpp"

namespace withy::reference {
namespace {

/// a + δb, δ² = 0: a derivative along a direction of deformation.
using Inner = DualNumber<double, 1>;
/// a + εb, ε² = 0, of these: orders in q.
using Nested = DualNumber<Inner, 1>;

Inner inner(double value, double derivative) {
  Inner d(value);
  d.derivatives()[0] = derivative;
  return d;
}

/// Two orders in ε of a matrix of numbers.
struct Orders {
  Eigen::MatrixXd zero, one;
  [[nodiscard]] Eigen::MatrixXd total() const { return zero + one; }
};
template <class Matrix>
Orders values(const Matrix& m) {
  return {m.unaryExpr([](const Nested& x) { return x.value().value(); }),
          m.unaryExpr([](const Nested& x) { return x.derivatives()[0].value(); })};
}
/// The same of the derivatives along the direction.
template <class Matrix>
Orders along(const Matrix& m) {
  return {m.unaryExpr([](const Nested& x) { return x.value().derivatives()[0]; }),
          m.unaryExpr([](const Nested& x) { return x.derivatives()[0].derivatives()[0]; })};
}

/// A piece of mass whose vector moves with the tree: a particle's place, or an axis of a section times the root of its
/// second moment, which may be negative as a weight.
struct Piece {
  double weight;
  bool heavy;       ///< it has weight: a particle
  M3X<Nested> J;    ///< of all speeds
  V3<Nested> v, a;  ///< velocity and acceleration of the rigid motion alone
};

/// The tree with hinges moving and shapes at εq + δ direction, frozen.
class Frozen {
 public:
  Frozen(const Model& model, const std::vector<Terms>& terms, std::span<const double> y,
         const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::VectorXd>& direction)
      : tree_(model, body_terms(model, terms), y, deformed(q, direction), at_rest(q)) {
    const auto add_section = [this](const Matrix3& inertia, const WorldMotion<Nested>& A) {
      const Matrix3 second = 0.5 * inertia.trace() * Matrix3::Identity() - inertia;
      const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(second);
      for (Eigen::Index k = 0; k < 3; ++k) {
        const V3<Nested> e = A.R * V3<Nested>(Vector3(eigen.eigenvectors().col(k)).cast<Nested>());
        pieces.push_back({eigen.eigenvalues()[k], false, -skew<Nested>(e) * A.JW, A.w.cross(e),
                          A.w_bias.cross(e) + A.w.cross(V3<Nested>(A.w.cross(e)))});
      }
    };
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      tree_.each(
          b,
          [this](double mass, const WorldMotion<Nested>& A) {
            pieces.push_back({mass, true, A.JV, A.v, A.v_bias});
          },
          add_section);
    }
  }
  /// Jacobian of a frame: velocity, then angular velocity.
  [[nodiscard]] std::pair<M3X<Nested>, M3X<Nested>> frame(FrameIndex at) const {
    const WorldMotion<Nested> A = tree_.frame(at.body, at.frame, Pose{});
    return {A.JV, A.JW};
  }

  std::vector<Piece> pieces;

 private:
  static std::vector<BodyTerms<Nested>> body_terms(const Model& model, const std::vector<Terms>& terms) {
    std::vector<BodyTerms<Nested>> all;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) all.push_back({terms[b].strain, Nested(0.0)});
    return all;
  }
  static std::vector<VX<Nested>> deformed(const std::vector<Eigen::VectorXd>& q,
                                          const std::vector<Eigen::VectorXd>& direction) {
    std::vector<VX<Nested>> all;
    for (std::size_t b = 0; b < q.size(); ++b) {
      all.emplace_back(q[b].size());
      for (Eigen::Index i = 0; i < q[b].size(); ++i) {
        all.back()[i] = Nested(inner(0, direction[b][i]));
        all.back()[i].derivatives()[0] = inner(q[b][i], 0);
      }
    }
    return all;
  }
  static std::vector<VX<Nested>> at_rest(const std::vector<Eigen::VectorXd>& q) {
    std::vector<VX<Nested>> all;
    for (const Eigen::VectorXd& each : q) all.push_back(VX<Nested>::Constant(each.size(), Nested(Inner(0.0))));
    return all;
  }

  ReferenceTree<Nested> tree_;
};

/// q, q̇ of every body as far as its truncation keeps them, and where its modes stand among the speeds.
struct Elastic {
  std::vector<Eigen::VectorXd> q, q_dot;
  std::vector<Eigen::Index> first;
  std::vector<bool> is_mode;  ///< of each speed

  Elastic(const Model& model, const std::vector<Terms>& terms, std::span<const double> y)
      : is_mode(model.layout().speeds, false) {
    const Layout& layout = model.layout();
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      const BodyNode& node = model.bodies()[b];
      const Eigen::Index n = node.body->shape().modes();
      q.emplace_back(Eigen::VectorXd::Zero(n));
      q_dot.emplace_back(Eigen::VectorXd::Zero(n));
      first.push_back(0);
      if (n == 0) continue;
      const Slot& slot = *layout.modes(b);
      first.back() = static_cast<Eigen::Index>(slot.speed);
      for (std::size_t i = 0; i < slot.speeds; ++i) is_mode[slot.speed + i] = true;
      if (terms[b].truncation == Truncation::ruthless) continue;
      q.back() = Eigen::Map<const Eigen::VectorXd>(y.data() + slot.position, n);
      q_dot.back() = Eigen::Map<const Eigen::VectorXd>(y.data() + layout.positions + slot.speed, n);
    }
  }
};

/// ⟨aᵀ b⟩ of matrices in two orders.
Eigen::MatrixXd product(const Orders& a, const Orders& b) {
  return a.zero.transpose().lazyProduct(b.total()) + a.one.transpose().lazyProduct(b.zero);
}

/// J to second order in the rows of hinges, to first in those of modes, applied to a constant vector. `J`: evaluated
/// along q, so that the first order of its derivative is twice the second order.
Eigen::VectorXd potential_rows(const M3X<Nested>& J, const std::vector<bool>& is_mode, const Vector3& force) {
  Eigen::VectorXd rows = values(J).total().transpose() * force;
  const Eigen::VectorXd second = 0.5 * along(J).one.transpose() * force;
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    if (!is_mode[static_cast<std::size_t>(i)]) rows[i] += second[i];
  }
  return rows;
}

}  // namespace

FirstOrderSystem first_order_system(const Model& model, const std::vector<Terms>& terms, std::span<const double> y,
                                    const std::vector<PlacedWrench>& wrenches) {
  const auto n = static_cast<Eigen::Index>(model.layout().speeds);
  FirstOrderSystem s{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  const Elastic elastic(model, terms, y);
  // The speeds that inertia forces see, and of them the elastic ones alone.
  Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(y.data() + model.layout().positions, n);
  Eigen::VectorXd u_elastic = Eigen::VectorXd::Zero(n);
  for (std::size_t b = 0; b < elastic.q.size(); ++b) {
    u.segment(elastic.first[b], elastic.q[b].size()) = elastic.q_dot[b];
    u_elastic.segment(elastic.first[b], elastic.q[b].size()) = elastic.q_dot[b];
  }

  const Frozen moving(model, terms, y, elastic.q, elastic.q_dot);
  std::vector<Orders> velocities;
  for (const Piece& piece : moving.pieces) {
    const Orders J = values(piece.J), dJ = along(piece.J), a = values(piece.a), dv = along(piece.v);
    const Orders v{J.zero * u, J.one * u};
    const Orders bias{a.zero + dv.zero, a.one + dv.one + dv.zero + dJ.zero * u_elastic};
    s.M += piece.weight * product(J, J);
    s.f -= piece.weight * product(J, bias);
    // (1 − ε) v · (−D[q̇] J_r) leaves the first order alone; the rows of modes follow below.
    Eigen::VectorXd rows = piece.weight * (dJ.one.transpose() * v.zero + dJ.zero.transpose() * v.one);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!elastic.is_mode[static_cast<std::size_t>(i)]) s.f[i] += rows[i];
    }
    velocities.push_back(v);
  }
  std::vector<Eigen::VectorXd> direction;
  for (const Eigen::VectorXd& q : elastic.q) direction.push_back(Eigen::VectorXd::Zero(q.size()));
  for (std::size_t b = 0; b < elastic.q.size(); ++b) {
    for (Eigen::Index k = 0; k < elastic.q[b].size(); ++k) {
      direction[b][k] = 1;
      const Frozen bent(model, terms, y, elastic.q, direction);
      direction[b][k] = 0;
      for (std::size_t p = 0; p < bent.pieces.size(); ++p) {
        const Orders dv = along(bent.pieces[p].v);
        const Orders& v = velocities[p];
        s.f[elastic.first[b] + k] -=
            bent.pieces[p].weight * (v.zero.col(0).dot(dv.one.col(0)) + v.one.col(0).dot(dv.zero.col(0)));
      }
    }
  }

  const Frozen stretched(model, terms, y, elastic.q, elastic.q);
  for (const Piece& piece : stretched.pieces) {
    if (piece.heavy) s.f += potential_rows(piece.J, elastic.is_mode, piece.weight * model.gravity());
  }
  for (const auto& [at, wrench] : wrenches) {
    const auto [linear, angular] = stretched.frame(at);
    s.applied +=
        potential_rows(linear, elastic.is_mode, wrench.force) + potential_rows(angular, elastic.is_mode, wrench.moment);
  }
  return s;
}

}  // namespace withy::reference
