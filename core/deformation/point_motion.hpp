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
      for (Eigen::Index i = 0; i < n; ++i) {
        S slope(0.0), slope_rate(0.0);
        for (Eigen::Index j = 0; j < n; ++j) {
          if (gamma(i, j) == 0) continue;
          slope += q[j] * gamma(i, j);
          slope_rate += q_dot[j] * gamma(i, j);
        }
        m.P(c, i) += slope;
        m.r[c] += S(0.5) * slope * q[i];
        m.r_bias[c] += slope_rate * q_dot[i];
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
      // Lazily: the blocks of great products, in numbers with derivatives, would take seconds to compile.
      const auto add = [&](const Eigen::MatrixXd& second, S& value, auto&& gradient, S& bias) {
        const auto form = second.template cast<S>().eval();
        const Eigen::Matrix<S, Eigen::Dynamic, 1> slope = form.lazyProduct(q), rate = form.lazyProduct(q_dot);
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
