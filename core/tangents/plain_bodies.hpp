/// \file
/// Numbers that carry derivatives beside plain ones, and what a body needs whose shape carries none.
#pragma once

#include "withy/core/tangents/recursion.hpp"

namespace withy::analysis {

inline double plain(const Jet& x) { return x.value(); }
inline Dual<double> plain(const Dual<Jet>& x) {
  Dual<double> d(x.value().value());
  d.derivatives()[0] = x.derivatives()[0].value();
  return d;
}
inline void lift(double x, Jet& y) { y = Jet(x); }
inline void lift(const Dual<double>& x, Dual<Jet>& y) {
  y = Dual<Jet>(Jet(x.value()));
  y.derivatives()[0] = Jet(x.derivatives()[0]);
}

/// A matrix of plain numbers in numbers that carry derivatives, which are zero.
template <class To, class From>
void lift_matrix(const From& from, To& to) {
  to.resize(from.rows(), from.cols());
  for (Eigen::Index j = 0; j < from.cols(); ++j) {
    for (Eigen::Index i = 0; i < from.rows(); ++i) lift(from(i, j), to(i, j));
  }
}

template <class S, class T>
PointMotionOf<S> lifted(const PointMotionOf<T>& m) {
  PointMotionOf<S> n;
  lift_matrix(m.r, n.r);
  lift_matrix(m.r_rate, n.r_rate);
  lift_matrix(m.r_bias, n.r_bias);
  lift_matrix(m.P, n.P);
  lift_matrix(m.R, n.R);
  lift_matrix(m.W, n.W);
  lift_matrix(m.w_rate, n.w_rate);
  lift_matrix(m.w_bias, n.w_bias);
  return n;
}

/// x by a number without its derivatives.
inline Jet scaled(const Jet& x, double by) { return x * by; }
inline Dual<Jet> scaled(const Dual<Jet>& x, const Dual<double>& by) {
  Dual<Jet> y(x.value() * by.value());
  y.derivatives()[0] = x.derivatives()[0] * by.value() + x.value() * by.derivatives()[0];
  return y;
}
/// A x.
template <class S, class Matrix>
Eigen::Matrix<S, 3, 1> scaled(const Matrix& A, const Eigen::Matrix<S, 3, 1>& x) {
  Eigen::Matrix<S, 3, 1> y;
  for (Eigen::Index i = 0; i < 3; ++i) y[i] = scaled(x[0], A(i, 0)) + scaled(x[1], A(i, 1)) + scaled(x[2], A(i, 2));
  return y;
}
/// A x, the derivatives being the matrix's.
template <class S, class Vector>
Eigen::Matrix<S, 3, 1> scaled_by(const Eigen::Matrix<S, 3, 3>& A, const Vector& x) {
  Eigen::Matrix<S, 3, 1> y;
  for (Eigen::Index i = 0; i < 3; ++i) y[i] = scaled(A(i, 0), x[0]) + scaled(A(i, 1), x[1]) + scaled(A(i, 2), x[2]);
  return y;
}
/// Σ A_ij B_ij.
template <class S, class Matrix>
S contracted(const Eigen::Matrix<S, 3, 3>& A, const Matrix& B) {
  S sum(0.0);
  for (Eigen::Index j = 0; j < 3; ++j)
    for (Eigen::Index i = 0; i < 3; ++i) sum += scaled(A(i, j), B(i, j));
  return sum;
}
template <class S, class Vector>
S dotted(const Eigen::Matrix<S, 3, 1>& a, const Vector& b) {
  return scaled(a[0], b[0]) + scaled(a[1], b[1]) + scaled(a[2], b[2]);
}
/// Numbers of plain ones.
template <class S, class From>
auto lifted_matrix(const From& from) {
  Eigen::Matrix<S, From::RowsAtCompileTime, From::ColsAtCompileTime> to;
  lift_matrix(from, to);
  return to;
}

/// What a body needs in its own axes, by its integrals.
template <class S, class T>
BodyLoad<S> load_of(const BodyIntegrals<T>& sums, const Turning<S>& t,
                    const Eigen::Matrix<S, Eigen::Dynamic, 1>& q_ddot) {
  using V3 = Eigen::Matrix<S, 3, 1>;
  const auto& [w, alpha, a, ww, turn, twice] = t;
  V3 f = a * S(sums.mass) + scaled_by<S>(turn, sums.r) + scaled_by<S>(twice, sums.r_rate) + lifted_matrix<S>(sums.bias);
  V3 n = lifted_matrix<S>(sums.r_bias);
  for (Eigen::Index i = 0; i < 3; ++i) {
    // (Σ m r × …)_i of what is linear in r and ṙ.
    const Eigen::Index j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] += scaled(a[k], sums.r[j]) - scaled(a[j], sums.r[k]);
    for (Eigen::Index d = 0; d < 3; ++d)
      n[i] += scaled(turn(k, d), sums.rr(d, j)) - scaled(turn(j, d), sums.rr(d, k)) +
              scaled(twice(k, d), sums.r_r_rate(j, d)) - scaled(twice(j, d), sums.r_r_rate(k, d));
  }
  if (sums.turns) {
    n += scaled<S>(sums.J, alpha) + w.cross(V3(scaled<S>(sums.J, w) + lifted_matrix<S>(sums.h))) +
         scaled<S>(sums.G, w) + lifted_matrix<S>(sums.k);
  }
  BodyLoad<S> load;
  load.modes = lifted_matrix<S>(sums.P_bias);
  for (Eigen::Index i = 0; i < q_ddot.size(); ++i) {
    const auto mode = static_cast<std::size_t>(i);
    S& own = load.modes[i];
    own +=
        dotted<S>(a, sums.P.col(i)) + contracted<S>(turn, sums.P_r[mode]) + contracted<S>(twice, sums.P_r_rate[mode]);
    for (Eigen::Index j = 0; j < q_ddot.size(); ++j) own += scaled(q_ddot[j], sums.PP(i, j));
    for (Eigen::Index c = 0; c < 3; ++c) {
      f[c] += scaled(q_ddot[i], sums.P(c, i));
      n[c] += scaled(q_ddot[i], sums.r_P(c, i));
    }
    if (!sums.turns) continue;
    own += dotted<S>(alpha, sums.F.col(i)) + contracted<S>(ww, sums.W_J[mode]) + dotted<S>(w, sums.W_G.col(i));
    for (Eigen::Index c = 0; c < 3; ++c) n[c] += scaled(q_ddot[i], sums.F(c, i));
  }
  load.force = f;
  load.moment = n;
  return load;
}

}  // namespace withy::analysis
