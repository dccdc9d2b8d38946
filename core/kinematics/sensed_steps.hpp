/// \file
/// Sets the hinges' steps and the modal coordinates of a pass from a state, in the scalar of the pass.
#pragma once

#include <array>

#include "withy/core/kinematics/frame_pass.hpp"
#include "withy/core/kinematics/sensed_pass.hpp"

namespace withy::sensed {

/// M in F, with rates in time: Ẋ_FM, and the twist's derivative H ẍ + Ḣ ẋ.
template <class S>
StepOf<S> hinge_step(const BodyPlan& body, std::span<const double> x, std::span<const double> rates,
                     std::span<const double> accelerations) noexcept {
  HingeMotion m;
  m.H.resize(6, static_cast<Eigen::Index>(rates.size()));
  body.hinge->hinge->motion(x, rates, m);
  Vector6 V = Vector6::Zero(), slope = m.bias;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    V += m.H.col(static_cast<Eigen::Index>(i)) * rates[i];
    slope += m.H.col(static_cast<Eigen::Index>(i)) * accelerations[i];
  }
  const Vector3 w = V.head<3>(), v = V.tail<3>();
  return {
      {with_rates<S>(m.pose.R, Matrix3(m.pose.R * skew<double>(w))), with_rates<S>(m.pose.p, Vector3(m.pose.R * v))},
      {with_rates<S>(w, Vector3(slope.head<3>())), with_rates<S>(v, Vector3(slope.tail<3>()))}};
}

/// A modal coordinate and its rate as a pass has them.
template <class S>
struct Mode {
  S q, u;
};

/// With rates in time, every body in its own strain kinematics without truncation.
inline Mode<First> moving_mode(double q, double q_dot, double q_ddot) {
  return {first(q, q_dot), first(q_dot, q_ddot)};
}
/// Of first order in (q, q̇, q̈).
inline Mode<Second> strict_mode(double q, double q_dot, double q_ddot) {
  return {Second(first(0, q), {first(0, q_dot)}), Second(first(0, q_dot), {first(0, q_ddot)})};
}
/// Of first order in the q of shapes and partial velocities, whatever the rates.
inline Mode<Second> symmetric_mode(double q, double q_dot, double q_ddot) {
  return {Second(first(0, q), {first(0, q_dot)}), Second(First(q_dot), {First(q_ddot)})};
}

/// What of a state a pass is set from.
struct Kept {
  bool ruthless = true;  ///< the deformation of ruthless bodies
  bool speeds = true;
};

/// Sets a pass from positions, speeds and accelerations as in State. `mode` is called with what is kept of q and q̇ of
/// each coordinate, and q̈.
template <class S, class OfMode>
void set_pass(Pass<S>& pass, const Plan& plan, std::span<const double> y, std::span<const double> accelerations,
              Kept keep, OfMode&& mode) noexcept {
  constexpr std::array<double, 6> none{};
  const std::size_t speeds = plan.model.layout().positions;
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    const BodyPlan& body = plan.bodies[b];
    const std::span<const double> at_rest(none.data(), body.slot.speeds);
    pass.hinges[b] = hinge_step<S>(body, y.subspan(body.slot.position, body.slot.positions),
                                   keep.speeds ? y.subspan(speeds + body.slot.speed, body.slot.speeds) : at_rest,
                                   accelerations.subspan(body.slot.speed, body.slot.speeds));
    const double kept = keep.ruthless || body.truncation != Truncation::ruthless ? 1 : 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(body.modes); ++i) {
      const double rate = keep.speeds ? kept * y[speeds + body.modal.speed + i] : 0;
      const Mode<S> m = mode(kept * y[body.modal.position + i], rate, accelerations[body.modal.speed + i]);
      pass.q[body.first_mode + i] = m.q;
      pass.u[body.first_mode + i] = m.u;
    }
  }
}

}  // namespace withy::sensed
