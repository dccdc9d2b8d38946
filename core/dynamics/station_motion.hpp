/// \file
/// Motion of a section relative to its body's frame, in the section's own axes: what hinges and carried bodies see.
#pragma once

#include "withy/core/dynamics/mass_table.hpp"
#include "withy/core/dynamics/sweep_node.hpp"
#include "withy/core/shape/point_motion.hpp"

namespace withy::sweep {

/// Pose of the section's frame S in the body frame B, and its motion relative to B in S axes: twist J q̇ and J̇ q̇.
template <class Space>
struct StationMotion {
  typename Space::Frame frame;
  typename Space::Twist rate;  ///< J q̇
  typename Space::Twist bias;  ///< J̇ q̇, component-wise in S
};

/// Evaluates a section at q, q̇; J receives n twists. R(q) = exp(θ̂) with θ = Ψq + ½qᵀΘq; in S axes the angular velocity
/// is T θ̇ with the right Jacobian T = 1 − b θ̂ + c θ̂².
template <class Space, int N>
inline void station_motion(const Fields<Space>& f, int modes, const double* q, const double* q_dot,
                           StationMotion<Space>& out, typename Space::Twist* J) {
  using Position = typename Space::Position;
  using Angular = typename Space::Angular;
  const int n = count<N>(modes);
  Position r = f.X;
  Position r_rate = Position::Zero();
  Position r_bias = Position::Zero();
  Angular t = Angular::Zero();
  Angular t_rate = Angular::Zero();
  Angular t_bias = Angular::Zero();
  constexpr int A = Space::angular;
  constexpr int L = Space::linear;
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Position P = f.phi[k];
    Angular T = f.psi[k];
    if (f.second_order) {
      for (int j = 0; j < n; ++j) {
        const auto kj = static_cast<std::size_t>(i * n + j);
        P += f.gamma[kj] * q[j];
        T += f.theta[kj] * q[j];
        r_bias += f.gamma[kj] * (q_dot[i] * q_dot[j]);
        t_bias += f.theta[kj] * (q_dot[i] * q_dot[j]);
      }
    }
    r += (0.5 * q[i]) * (f.phi[k] + P);
    t += (0.5 * q[i]) * (f.psi[k] + T);
    r_rate += P * q_dot[i];
    t_rate += T * q_dot[i];
    J[i].template head<A>() = T;
    J[i].template tail<L>() = P;
  }
  out.frame.p = r;
  if constexpr (A == 1) {
    out.frame.R = Space::about_z(std::cos(t[0]), std::sin(t[0]));
    for (int i = 0; i < n; ++i) J[i].template tail<L>() = Space::unrotate(out.frame.R, J[i].template tail<L>());
    const Position v = Space::unrotate(out.frame.R, r_rate);
    const Position b = Space::unrotate(out.frame.R, r_bias);
    out.rate << t_rate, v;
    out.bias << t_bias, b[0] + t_rate[0] * v[1], b[1] - t_rate[0] * v[0];
  } else {
    const detail::ExponentialCoefficients<double> k(t.squaredNorm());
    const Eigen::Matrix3d hat = skew<double>(t);
    const Eigen::Matrix3d hat2 = hat * hat;
    const Eigen::Matrix3d hat_rate = skew<double>(t_rate);
    out.frame.R = Eigen::Matrix3d::Identity() + k.a * hat + k.b * hat2;
    const Eigen::Matrix3d right = Eigen::Matrix3d::Identity() - k.b * hat + k.c * hat2;
    const double half_s_rate = t.dot(t_rate);
    const Eigen::Matrix3d right_rate =
        2 * half_s_rate * (k.dc * hat2 - k.db * hat) - k.b * hat_rate + k.c * (hat_rate * hat + hat * hat_rate);
    for (int i = 0; i < n; ++i) {
      const Angular T = J[i].template head<3>();
      const Position P = J[i].template tail<3>();
      J[i].template head<3>() = right * T;
      J[i].template tail<3>() = out.frame.R.transpose() * P;
    }
    const Position v = out.frame.R.transpose() * r_rate;
    const Angular w = right * t_rate;
    out.rate << w, v;
    out.bias.template head<3>() = right_rate * t_rate + right * t_bias;
    out.bias.template tail<3>() = out.frame.R.transpose() * r_bias - w.cross(v);
  }
}

}  // namespace withy::sweep
