/// \file
/// Motion of a material point from its second-order expansion, for any scalar (double, or a dual number whose
/// derivative part carries the first order in the elastic coordinates).
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "withy/core/deformation/point_kinematics.hpp"
#include "withy/core/plugin/terms.hpp"
#include "withy/core/shape/modal_shape.hpp"
#include "withy/core/spatial/jet.hpp"

namespace withy {

/// PointMotion for a scalar S; see there for meaning, frames and units.
template <class S>
struct PointMotionOf {
  using V3 = Eigen::Matrix<S, 3, 1>;
  using M3 = Eigen::Matrix<S, 3, 3>;
  using M3X = Eigen::Matrix<S, 3, Eigen::Dynamic>;
  V3 r, r_rate, r_bias, w_rate, w_bias;  ///< also ṙ and the section's angular velocity relative to the body
  M3 R;
  M3X P, W;
};

namespace detail {

/// Coefficients of the exponential map as functions of s = |θ|²: a = sin|θ|/|θ|, b = (1−cos|θ|)/|θ|²,
/// c = (|θ|−sin|θ|)/|θ|³, and db = b′(s), dc = c′(s). The series serves where the closed forms cancel.
template <class S>
struct ExponentialCoefficients {
  S a, b, c, db, dc;
  explicit ExponentialCoefficients(const S& s) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    if (s < 0.25) {
      // Σ (−s)^k/(2k+1)!, (2k+2)!, (2k+3)!; terms to k = 8 leave less than 1e-19 at s = ¼.
      a = b = c = db = dc = S(0);
      for (int k = terms - 1; k >= 0; --k) {
        a = S(series[0][k]) + s * a;
        b = S(series[1][k]) + s * b;
        c = S(series[2][k]) + s * c;
      }
      for (int k = terms - 1; k >= 1; --k) {
        db = S(k * series[1][k]) + s * db;
        dc = S(k * series[2][k]) + s * dc;
      }
    } else {
      const S angle = sqrt(s);
      a = sin(angle) / angle;
      b = (S(1) - cos(angle)) / s;
      c = (S(1) - a) / s;
      db = (a - S(2) * b) / (S(2) * s);
      dc = (b - S(3) * c) / (S(2) * s);
    }
  }

 private:
  static constexpr int terms = 9;
  /// (−1)^k / (2k+1)!, (2k+2)!, (2k+3)!
  static constexpr std::array<std::array<double, terms>, 3> series = [] {
    std::array<std::array<double, terms>, 3> table{};
    for (int shift = 1; shift <= 3; ++shift) {
      for (int k = 0; k < terms; ++k) {
        double f = k % 2 == 0 ? 1.0 : -1.0;
        for (int i = 2; i <= 2 * k + shift; ++i) f /= i;
        table[static_cast<std::size_t>(shift - 1)][static_cast<std::size_t>(k)] = f;
      }
    }
    return table;
  }();
};

}  // namespace detail

/// M x.
template <class S>
Eigen::Matrix<S, Eigen::Dynamic, 1> form_times(const Eigen::MatrixXd& M, const Eigen::Matrix<S, Eigen::Dynamic, 1>& x) {
  Eigen::Matrix<S, Eigen::Dynamic, 1> product(M.rows());
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    product[i] = S(0.0);
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      if (M(i, j) != 0) product[i] += x[j] * M(i, j);
  }
  return product;
}
/// Few of many modes carry derivatives at a time: of those the others count by their values alone.
inline Eigen::Matrix<Jet, Eigen::Dynamic, 1> form_times(const Eigen::MatrixXd& M,
                                                        const Eigen::Matrix<Jet, Eigen::Dynamic, 1>& x) {
  if (x.size() <= static_cast<Eigen::Index>(jet_directions)) return form_times<Jet>(M, x);
  Eigen::Matrix<double, Eigen::Dynamic, jet_directions> derivatives =
      Eigen::Matrix<double, Eigen::Dynamic, jet_directions>::Zero(M.rows(), static_cast<Eigen::Index>(jet_directions));
  Eigen::VectorXd values(x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    values[j] = x[j].value();
    for (std::size_t k = 0; k < jet_directions; ++k)
      if (const double of = x[j].derivatives()[k]; of != 0)
        derivatives.col(static_cast<Eigen::Index>(k)) += of * M.col(j);
  }
  values = (M * values).eval();
  Eigen::Matrix<Jet, Eigen::Dynamic, 1> product(M.rows());
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    product[i] = Jet(values[i]);
    derivatives_of(product[i]) = derivatives.row(i).transpose();
  }
  return product;
}

/// r, ṙ, P and Ṗ q̇ of point_motion alone: all a particle needs, which has no rotation. R, W and their rates are left
/// unset.
template <class S>
PointMotionOf<S> path_motion(const PointExpansion& e, StrainOrder order, const Eigen::Matrix<S, Eigen::Dynamic, 1>& q,
                             const Eigen::Matrix<S, Eigen::Dynamic, 1>& q_dot) {
  PointMotionOf<S> m;
  const Eigen::Index n = q.size();
  m.P = e.phi.template cast<S>();
  m.r_bias.setZero();
  m.r = e.X.template cast<S>() + m.P * q;
  if (order != StrainOrder::linear && n > 0) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      const Eigen::MatrixXd& gamma = e.gamma[static_cast<std::size_t>(c)];
      if (gamma.isZero(0)) continue;
      const Eigen::Matrix<S, Eigen::Dynamic, 1> slope = form_times(gamma, q), slope_rate = form_times(gamma, q_dot);
      for (Eigen::Index i = 0; i < n; ++i) {
        m.P(c, i) += slope[i];
        m.r[c] += S(0.5) * slope[i] * q[i];
        m.r_bias[c] += slope_rate[i] * q_dot[i];
      }
    }
  }
  m.r_rate = m.P * q_dot;
  return m;
}

/// Evaluates theory (1), (2), to second order unless `order` is linear, and their rates at q, q̇. With R = exp(θ̂) the
/// section's angular velocity is T(θ) θ̇, T = 1 + b θ̂ + c θ̂² (left Jacobian of the rotation group).
template <class S>
PointMotionOf<S> point_motion(const PointExpansion& e, StrainOrder order, const Eigen::Matrix<S, Eigen::Dynamic, 1>& q,
                              const Eigen::Matrix<S, Eigen::Dynamic, 1>& q_dot) {
  using V3 = typename PointMotionOf<S>::V3;
  using M3 = typename PointMotionOf<S>::M3;
  PointMotionOf<S> m;
  const Eigen::Index n = q.size();
  m.P = e.phi.template cast<S>();
  typename PointMotionOf<S>::M3X T = e.psi.template cast<S>();  // ∂θ/∂q
  m.r_bias.setZero();
  V3 theta_bias = V3::Zero();
  V3 theta = T * q;
  m.r = e.X.template cast<S>() + m.P * q;
  if (order != StrainOrder::linear && n > 0) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto add = [&](const Eigen::MatrixXd& second, S& value, auto&& gradient, S& bias) {
        if (second.isZero(0)) return;
        const Eigen::Matrix<S, Eigen::Dynamic, 1> slope = form_times(second, q), rate = form_times(second, q_dot);
        value += S(0.5) * q.dot(slope);
        gradient += slope.transpose();
        bias = q_dot.dot(rate);
      };
      add(e.gamma[static_cast<std::size_t>(c)], m.r[c], m.P.row(c), m.r_bias[c]);
      add(e.theta[static_cast<std::size_t>(c)], theta[c], T.row(c), theta_bias[c]);
    }
  }
  m.r_rate = m.P * q_dot;
  const V3 theta_rate = T * q_dot;
  const detail::ExponentialCoefficients<S> k(theta.squaredNorm());
  const M3 t = skew<S>(theta);
  const M3 t_rate = skew<S>(theta_rate);
  const M3 left = M3::Identity() + k.b * t + k.c * (t * t);
  m.R = M3::Identity() + k.a * t + k.b * (t * t);
  m.W = left * T;
  m.w_rate = m.W * q_dot;
  const S half_s_rate = theta.dot(theta_rate);  // ½ d|θ|²/dt
  const M3 left_rate =
      S(2) * half_s_rate * (k.db * t + k.dc * (t * t)) + k.b * t_rate + k.c * (t_rate * t + t * t_rate);
  m.w_bias = left_rate * theta_rate + left * theta_bias;
  return m;
}

/// r and ṙ of point_motion alone, without allocating: for energies and deflections, asked for at every step of a run.
template <class Vector>
std::pair<Vector3, Vector3> point_velocity(const PointExpansion& e, StrainOrder order, const Vector& q,
                                           const Vector& q_dot) {
  Vector3 r = e.X, r_rate = Vector3::Zero();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Vector3 phi = e.phi.col(i);
    Vector3 P = phi;
    if (order != StrainOrder::linear) {
      for (Eigen::Index j = 0; j < q.size(); ++j)
        P += Vector3(e.gamma[0](i, j), e.gamma[1](i, j), e.gamma[2](i, j)) * q[j];
    }
    r += (phi + P) * (0.5 * q[i]);
    r_rate += P * q_dot[i];
  }
  return {r, r_rate};
}

/// Motion of a frame fixed at `offset` to the section whose motion is `section`.
template <class S>
PointMotionOf<S> offset_motion(const PointMotionOf<S>& section, const Pose& offset) {
  using V3 = typename PointMotionOf<S>::V3;
  PointMotionOf<S> m = section;
  const V3 arm = section.R * offset.p.template cast<S>();
  m.r += arm;
  m.r_rate += section.w_rate.cross(arm);
  m.r_bias += section.w_bias.cross(arm) + section.w_rate.cross(section.w_rate.cross(arm));
  m.P -= skew<S>(arm) * section.W;
  m.R = section.R * offset.R.template cast<S>();
  return m;
}

/// Strain kinematics given by expansions: `linear` or `quadratic`.
class PolynomialKinematics final : public PointKinematics {
 public:
  PolynomialKinematics(std::vector<PointExpansion> points, StrainOrder order, Eigen::Index modes)
      : points_(std::move(points)), order_(order), modes_(modes) {}
  [[nodiscard]] Eigen::Index modes() const override { return modes_; }
  [[nodiscard]] std::size_t points() const override { return points_.size(); }
  void evaluate(std::span<const double> q, std::span<const double> q_dot,
                std::span<PointMotion> motions) const override;

 private:
  std::vector<PointExpansion> points_;
  StrainOrder order_;
  Eigen::Index modes_;
};

}  // namespace withy
