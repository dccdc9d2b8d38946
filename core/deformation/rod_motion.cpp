#include "withy/core/deformation/rod_motion.hpp"

#include <algorithm>
#include <type_traits>

namespace withy {
namespace {

constexpr Eigen::Index order = RodTable::turn_order;
template <class S>
using V3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using M3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using VX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <class S>
using Strains = Eigen::Matrix<S, order, 3>;
template <class S>
using Rotations = Eigen::Matrix<S, order, 9>;  ///< row-major, one row a node

/// linear(m) for an operation on matrices of doubles that acts on each column alike: on values and derivatives at once.
template <class Derived, class Linear>
auto by_columns(const Eigen::MatrixBase<Derived>& m, Linear&& linear) {
  if constexpr (std::is_same_v<typename Derived::Scalar, double>) {
    return linear(m.derived());
  } else {
    constexpr Eigen::Index parts = 1 + jet_directions;
    Eigen::MatrixXd flat(m.rows(), m.cols() * parts);
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      for (Eigen::Index i = 0; i < m.rows(); ++i)
        flat.block<1, parts>(i, j * parts) << m(i, j).value(), derivatives_of(m(i, j)).transpose();
    }
    const Eigen::MatrixXd image = linear(flat);
    MX<Jet> result(image.rows(), m.cols());
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      for (Eigen::Index i = 0; i < image.rows(); ++i) {
        result(i, j) = image(i, j * parts);
        derivatives_of(result(i, j)) = image.block<1, parts - 1>(i, j * parts + 1).transpose();
      }
    }
    return result;
  }
}

/// R κ̂: each row a of R becomes a κ̂ = a × κ.
template <class S>
Rotations<S> slopes(const Rotations<S>& R, const Strains<S>& kappa) {
  Rotations<S> slope;
  for (const Eigen::Index row : {0, 3, 6}) {
    const auto x = R.col(row).array(), y = R.col(row + 1).array(), z = R.col(row + 2).array();
    slope.col(row) = y * kappa.col(2).array() - z * kappa.col(1).array();
    slope.col(row + 1) = z * kappa.col(0).array() - x * kappa.col(2).array();
    slope.col(row + 2) = x * kappa.col(1).array() - y * kappa.col(0).array();
  }
  return slope;
}

/// R at the end of an interval of length h: R = R_a + ∫ R κ̂ by Gauss collocation of order 16, iterated to rounding
/// whatever the angle. `strains` is of RodTable::strains_between.
template <class S>
M3<S> turned(const RodTable& table, const M3<S>& R_a, const Eigen::MatrixXd& strains, const VX<S>& q, double h) {
  const VX<S> by_node = by_columns(q, [&](const auto& m) { return (strains * m).eval(); });
  const Strains<S> kappa = S(h) * Eigen::Map<const Eigen::Matrix<S, 3, order>>(by_node.data()).transpose();
  const Eigen::Matrix<double, order, order> running = table.turn.running();
  const Eigen::Map<const Eigen::Matrix<double, 1, order>> weights(table.turn.weights().data());
  Eigen::Matrix<S, 1, 9> before;
  before << R_a.row(0), R_a.row(1), R_a.row(2);
  Rotations<S> R = before.template replicate<order, 1>();
  // Picard's iteration: the k-th leaves (angle of the interval)ᵏ/k!.
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Rotations<S> next =
        by_columns(slopes<S>(R, kappa), [&](const auto& m) { return (running * m).eval(); }).rowwise() + before;
    double change = 0;
    for (Eigen::Index i = 0; i < next.size(); ++i) change = std::max(change, magnitude(S(next(i) - R(i))));
    R = next;
    if (!(change > 1e-15)) break;
  }
  const Eigen::Matrix<S, 1, 9> end =
      before + by_columns(slopes<S>(R, kappa), [&](const auto& m) { return (weights * m).eval(); });
  M3<S> R_b;
  R_b << end.template leftCols<3>(), end.template middleCols<3>(3), end.template rightCols<3>();
  return R_b;
}

/// R behind some pieces of the rod.
template <class S>
M3<S> turned(const RodTable& table, M3<S> R, const std::vector<RodTable::Piece>& pieces, const VX<S>& q) {
  for (const RodTable::Piece& piece : pieces) R = turned<S>(table, R, piece.strains, q, piece.to - piece.from);
  return R;
}

/// The root of a rod whose modes turn it: R, w_i, b.
template <class S>
PointMotionOf<S> root_motion(const RodTable& table, const VX<S>& q, const VX<S>& q_dot) {
  return point_motion<S>(*table.root, StrainOrder::linear, q, q_dot);
}

/// R at x = 0.
template <class S>
M3<S> root_turn(const RodTable& table, const VX<S>& q) {
  return table.root ? root_motion<S>(table, q, VX<S>::Zero(q.size())).R : M3<S>(M3<S>::Identity());
}

/// R at every node.
template <class S>
std::vector<M3<S>> rotations(const RodTable& table, const VX<S>& q) {
  std::vector<M3<S>> R;
  for (const std::vector<RodTable::Piece>& pieces : table.to_node)
    R.push_back(turned<S>(table, R.empty() ? root_turn<S>(table, q) : R.back(), pieces, q));
  return R;
}

/// γ of a section at q.
template <class S>
V3<S> elongation(const RodSection& section, const VX<S>& q) {
  if (section.elongation.cols() == 0) return V3<S>::Zero();
  return section.elongation.template cast<S>() * q;
}

/// r′ = R (e_x + γ) without e_x and its first order.
template <class S>
V3<S> stretch(const M3<S>& R, const RodSection& section, const VX<S>& q) {
  const V3<S> turn = section.rotation.template cast<S>() * q;
  const V3<S> axis = V3<S>::UnitX();
  V3<S> rest = R.col(0) - axis - turn.cross(axis);
  if (const V3<S> gamma = elongation<S>(section, q); section.elongation.cols() > 0) rest += R * gamma - gamma;
  return rest;
}

template <class S, class Derived>
V3<S> vector(const Eigen::MatrixBase<Derived>& m, Eigen::Index row, Eigen::Index column) {
  return m.template block<1, 3>(row, column).transpose();
}

}  // namespace

template <class S>
RodMotionOf<S>::RodMotionOf(const RodTable& table, const Vector& q, const Vector& q_dot)
    : table_(table), q_(q), q_dot_(q_dot), R_(rotations<S>(table, q)) {
  const auto nodes = static_cast<Eigen::Index>(R_.size());
  const Eigen::Index n = q.size();
  const Eigen::Index w = 3, P = w + 3 * n, b = P + 3 * n, a = b + 3;
  slopes_ = at_nodes_ = Matrix::Zero(nodes, a + 3);
  if (table.root) {
    const PointMotionOf<S> root = root_motion<S>(table, q, q_dot);
    root_ = RowVector::Zero(a + 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3 psi = table.root->psi.col(i);
      root_.template segment<3>(w + 3 * i) = (root.W.col(i) - psi.cast<S>()).transpose();
    }
    root_.template segment<3>(b) = root.w_bias.transpose();
  }
  const auto integrate = [&](Eigen::Index column, Eigen::Index count) {
    at_nodes_.middleCols(column, count) = by_columns(slopes_.middleCols(column, count), [&](const Eigen::MatrixXd& m) {
      return table.quadrature.running_integral(m);
    });
    if (table.root) at_nodes_.middleCols(column, count).rowwise() += root_.segment(column, count);
  };
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const M3<S>& R = R_[static_cast<std::size_t>(k)];
    const RodSection& section = table.sections[static_cast<std::size_t>(k)];
    slopes_.template block<1, 3>(k, 0) = stretch<S>(R, section, q).transpose();
    const auto strain = section.strain.cast<S>().eval();
    const Eigen::Matrix<S, 3, Eigen::Dynamic> u = R * strain - strain;
    for (Eigen::Index i = 0; i < n; ++i) slopes_.template block<1, 3>(k, w + 3 * i) = u.col(i).transpose();
  }
  integrate(0, P);
  Eigen::Matrix<S, 3, Eigen::Dynamic> omega = Eigen::Matrix<S, 3, Eigen::Dynamic>::Zero(3, nodes);
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const M3<S>& R = R_[static_cast<std::size_t>(k)];
    const RodSection& section = table.sections[static_cast<std::size_t>(k)];
    const bool stretches = section.elongation.cols() > 0;
    const V3<S> along = R * (V3<S>::UnitX() + elongation<S>(section, q));
    const V3<S> rate = R * V3<S>(section.strain.cast<S>() * q_dot);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3 psi = section.rotation.col(i);
      const V3<S> wi = psi.cast<S>() + vector<S>(at_nodes_, k, w + 3 * i);
      omega.col(k) += wi * q_dot[i];
      V3<S> slope = wi.cross(along) - psi.cross(Vector3::UnitX()).template cast<S>();
      if (stretches) {
        const V3<S> gamma = Vector3(section.elongation.col(i)).cast<S>();
        slope += R * gamma - gamma;
      }
      slopes_.template block<1, 3>(k, P + 3 * i) = slope.transpose();
    }
    slopes_.template block<1, 3>(k, b) = V3<S>(omega.col(k)).cross(rate).transpose();
  }
  integrate(P, 3 * n + 3);
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const M3<S>& R = R_[static_cast<std::size_t>(k)];
    const RodSection& section = table.sections[static_cast<std::size_t>(k)];
    const V3<S> along = R * (V3<S>::UnitX() + elongation<S>(section, q)), spin = omega.col(k);
    const V3<S> stretching = R * (elongation<S>(section, q_dot) * S(2));
    slopes_.template block<1, 3>(k, a) =
        (vector<S>(at_nodes_, k, b).cross(along) + spin.cross(V3<S>(spin.cross(along) + stretching))).transpose();
  }
  integrate(a, 3);
}

template <class S>
PointMotionOf<S> RodMotionOf<S>::motion(const M3<S>& R, const RowVector& integrals, double x,
                                        const RodSection& section) const {
  const Eigen::Index n = q_dot_.size();
  PointMotionOf<S> m;
  m.R = R;
  m.r = (x * Vector3::UnitX()).template cast<S>() + section.deflection.cast<S>() * q_ + vector<S>(integrals, 0, 0);
  m.W = section.rotation.cast<S>();
  m.P = section.deflection.cast<S>();
  for (Eigen::Index i = 0; i < n; ++i) {
    m.W.col(i) += vector<S>(integrals, 0, 3 + 3 * i);
    m.P.col(i) += vector<S>(integrals, 0, 3 + 3 * n + 3 * i);
  }
  m.w_bias = vector<S>(integrals, 0, 3 + 6 * n);
  m.r_bias = vector<S>(integrals, 0, 6 + 6 * n);
  m.w_rate = m.W * q_dot_;
  m.r_rate = m.P * q_dot_;
  return m;
}

template <class S>
PointMotionOf<S> RodMotionOf<S>::at_node(std::size_t node) const {
  return motion(R_[node], at_nodes_.row(static_cast<Eigen::Index>(node)), table_.quadrature.nodes()[node],
                table_.sections[node]);
}

template <class S>
PointMotionOf<S> RodMotionOf<S>::at(double x) const {
  const std::vector<double>& nodes = table_.quadrature.nodes();
  const auto next = static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), x) - nodes.begin());
  const double from = next > 0 ? nodes[next - 1] : 0.0;
  const M3<S> R =
      turned<S>(table_, next > 0 ? R_[next - 1] : root_turn<S>(table_, q_), table_.pieces_between(from, x), q_);
  RowVector integrals =
      by_columns(slopes_, [&](const Eigen::MatrixXd& m) { return table_.quadrature.integral_to(x, m); });
  if (table_.root) integrals += root_;
  return motion(R, integrals, x, table_.rod->section(x));
}

template <class S>
V3<S> RodMotionOf<S>::position(const RodTable& table, const Vector& q, double x) {
  const Eigen::RowVectorXd weights = table.quadrature.weights_to(x);
  const std::vector<M3<S>> R = rotations<S>(table, q);
  V3<S> r = (x * Vector3::UnitX()).template cast<S>() + table.rod->section(x).deflection.template cast<S>() * q;
  for (std::size_t k = 0; k < R.size(); ++k)
    r += S(weights[static_cast<Eigen::Index>(k)]) * stretch<S>(R[k], table.sections[k], q);
  return r;
}

template class RodMotionOf<double>;
template class RodMotionOf<Jet>;

}  // namespace withy
