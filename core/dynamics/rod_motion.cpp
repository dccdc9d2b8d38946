#include "withy/core/dynamics/rod_motion.hpp"

#include <algorithm>

namespace withy {
namespace {

constexpr Eigen::Index order = RodTable::turn_order;
using Strains = Eigen::Matrix<double, order, 3>;
using Rotations = Eigen::Matrix<double, order, 9>;  ///< row-major, one row a node

/// R κ̂: each row a of R becomes a κ̂ = a × κ.
Rotations slopes(const Rotations& R, const Strains& kappa) {
  Rotations slope;
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
Matrix3 turned(const RodTable& table, const Matrix3& R_a, const Eigen::MatrixXd& strains, const Eigen::VectorXd& q,
               double h) {
  const Eigen::VectorXd by_node = strains * q;
  const Strains kappa = h * Eigen::Map<const Eigen::Matrix<double, 3, order>>(by_node.data()).transpose();
  const Eigen::Matrix<double, order, order> running = table.turn.running();
  const Eigen::Map<const Eigen::Matrix<double, 1, order>> weights(table.turn.weights().data());
  using Flat = Eigen::Matrix<double, 1, 9>;
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const RowMajor begin = R_a;
  const Flat before = Eigen::Map<const Flat>(begin.data());
  Rotations R = before.replicate<order, 1>();
  // Picard's iteration: the k-th leaves (angle of the interval)ᵏ/k!.
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Rotations next = (running * slopes(R, kappa)).rowwise() + before;
    const double change = (next - R).cwiseAbs().maxCoeff();
    R = next;
    if (!(change > 1e-15)) break;
  }
  const Flat end = before + weights * slopes(R, kappa);
  return Eigen::Map<const RowMajor>(end.data());
}

/// R at every node.
std::vector<Matrix3> rotations(const RodTable& table, const Eigen::VectorXd& q) {
  std::vector<Matrix3> R;
  double before = 0;
  for (std::size_t k = 0; k < table.sections.size(); ++k) {
    const double x = table.quadrature.nodes()[k];
    R.push_back(turned(table, R.empty() ? Matrix3::Identity() : R.back(), table.to_node[k], q, x - before));
    before = x;
  }
  return R;
}

/// r′ = R e_x without e_x and its first order.
Vector3 stretch(const Matrix3& R, const RodSection& section, const Eigen::VectorXd& q) {
  return R.col(0) - Vector3::UnitX() - Vector3(section.rotation * q).cross(Vector3::UnitX());
}

Vector3 vector(const Eigen::MatrixXd& m, Eigen::Index row, Eigen::Index column) {
  return m.block<1, 3>(row, column).transpose();
}

}  // namespace

RodMotion::RodMotion(const RodTable& table, const Eigen::VectorXd& q, const Eigen::VectorXd& q_dot)
    : table_(table), q_(q), q_dot_(q_dot), R_(rotations(table, q)) {
  const auto nodes = static_cast<Eigen::Index>(R_.size());
  const Eigen::Index n = q.size();
  const Eigen::Index w = 3, P = w + 3 * n, b = P + 3 * n, a = b + 3;
  slopes_ = at_nodes_ = Eigen::MatrixXd::Zero(nodes, a + 3);
  const auto integrate = [&](Eigen::Index column, Eigen::Index count) {
    at_nodes_.middleCols(column, count) = table.quadrature.running_integral(slopes_.middleCols(column, count));
  };
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const Matrix3& R = R_[static_cast<std::size_t>(k)];
    const RodSection& section = table.sections[static_cast<std::size_t>(k)];
    slopes_.block<1, 3>(k, 0) = stretch(R, section, q).transpose();
    const Matrix3X u = R * section.strain - section.strain;
    for (Eigen::Index i = 0; i < n; ++i) slopes_.block<1, 3>(k, w + 3 * i) = u.col(i).transpose();
  }
  integrate(0, P);
  Matrix3X omega = Matrix3X::Zero(3, nodes);
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const Matrix3& R = R_[static_cast<std::size_t>(k)];
    const Vector3 t = R.col(0);
    const RodSection& section = table.sections[static_cast<std::size_t>(k)];
    const Vector3 rate = R * section.strain * q_dot;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vector3 psi = section.rotation.col(i);
      const Vector3 wi = psi + vector(at_nodes_, k, w + 3 * i);
      omega.col(k) += wi * q_dot[i];
      slopes_.block<1, 3>(k, P + 3 * i) = (wi.cross(t) - psi.cross(Vector3::UnitX())).transpose();
    }
    slopes_.block<1, 3>(k, b) = omega.col(k).cross(rate).transpose();
  }
  integrate(P, 3 * n + 3);
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const Vector3 t = R_[static_cast<std::size_t>(k)].col(0), spin = omega.col(k);
    slopes_.block<1, 3>(k, a) = (vector(at_nodes_, k, b).cross(t) + spin.cross(spin.cross(t))).transpose();
  }
  integrate(a, 3);
}

PointMotionOf<double> RodMotion::motion(const Matrix3& R, const Eigen::RowVectorXd& integrals, double x,
                                        const RodSection& section) const {
  const Eigen::Index n = q_dot_.size();
  PointMotionOf<double> m;
  m.R = R;
  m.r = x * Vector3::UnitX() + section.deflection * q_ + vector(integrals, 0, 0);
  m.W = section.rotation + Eigen::Map<const Matrix3X>(integrals.data() + 3, 3, n);
  m.P = section.deflection + Eigen::Map<const Matrix3X>(integrals.data() + 3 + 3 * n, 3, n);
  m.w_bias = vector(integrals, 0, 3 + 6 * n);
  m.r_bias = vector(integrals, 0, 6 + 6 * n);
  m.w_rate = m.W * q_dot_;
  m.r_rate = m.P * q_dot_;
  return m;
}

PointMotionOf<double> RodMotion::at_node(std::size_t node) const {
  return motion(R_[node], at_nodes_.row(static_cast<Eigen::Index>(node)), table_.quadrature.nodes()[node],
                table_.sections[node]);
}

PointMotionOf<double> RodMotion::at(double x) const {
  const std::vector<double>& nodes = table_.quadrature.nodes();
  const auto next = static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), x) - nodes.begin());
  const double from = next > 0 ? nodes[next - 1] : 0.0;
  const Matrix3 R =
      turned(table_, next > 0 ? R_[next - 1] : Matrix3::Identity(), table_.strains_between(from, x), q_, x - from);
  return motion(R, table_.quadrature.integral_to(x, slopes_), x, table_.rod->section(x));
}

Vector3 RodMotion::position(const RodTable& table, const Eigen::VectorXd& q, double x) {
  const Eigen::RowVectorXd weights = table.quadrature.weights_to(x);
  const std::vector<Matrix3> R = rotations(table, q);
  Vector3 r = x * Vector3::UnitX() + table.rod->section(x).deflection * q;
  for (std::size_t k = 0; k < R.size(); ++k)
    r += weights[static_cast<Eigen::Index>(k)] * stretch(R[k], table.sections[k], q);
  return r;
}

}  // namespace withy
