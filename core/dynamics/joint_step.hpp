/// \file
/// What the sweeps do at a hinge: its motion on the way out, and the rates between State and the aligned axes.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "withy/core/dynamics/sweep_node.hpp"

namespace withy::sweep {

/// Small matrices of a hinge: as many columns as it has rates, at most the size of a twist; never on the heap.
template <class Space>
using JointColumns = Eigen::Matrix<double, Space::dim, Eigen::Dynamic, 0, Space::dim, Space::dim>;
template <class Space>
using JointRows = Eigen::Matrix<double, Eigen::Dynamic, Space::dim, 0, Space::dim, Space::dim>;
template <class Space>
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Space::dim, Space::dim>;
template <class Space>
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Space::dim, 1>;

/// A hinge at one state.
template <class Space>
struct JointMotion {
  typename Space::Frame SM;    ///< pose of M in the frame that holds the hinge on the parent
  typename Space::Twist rate;  ///< H ẋ in M
  typename Space::Twist bias;  ///< Ḣ ẋ, component-wise in M
};

/// H of a hinge in M, for hinges that are not inlined one row at a time. Ball and free: H u̇ with u̇ in F axes.
template <class Space>
inline JointColumns<Space> motion_subspace(const JointData<Space>& joint, const double* x, const double* u) {
  JointColumns<Space> H;
  if constexpr (Space::angular == 3) {
    HingeMotion m;
    m.H.resize(6, static_cast<Eigen::Index>(joint.speeds));
    joint.hinge->motion({x, joint.positions}, {u, joint.speeds}, m);
    H = m.H;
  }
  return H;
}

/// Pose, rate and bias of a hinge at coordinates x and rates u (its own, not the whole State's).
template <class Space>
inline void joint_motion(const JointData<Space>& joint, const double* x, const double* u, JointMotion<Space>& out) {
  out.rate.setZero();
  out.bias.setZero();
  switch (joint.kind) {
    case Joint::fixed:
      out.SM = joint.F;
      return;
    case Joint::rotate:
      out.rate[JointData<Space>::row(Joint::rotate)] = joint.direction * u[0];
      out.SM = joint.F;
      if (!joint.pose_matters) return;
      out.SM.R = Space::compose({joint.F.R, Space::Position::Zero()},
                                {Space::about_z(std::cos(joint.direction * x[0]), std::sin(joint.direction * x[0])),
                                 Space::Position::Zero()})
                     .R;
      return;
    case Joint::slide: {
      typename Space::Position along = Space::Position::Zero();
      along[0] = joint.direction * x[0];
      out.SM = {joint.F.R, joint.F.p + Space::rotate(joint.F.R, along)};
      out.rate[JointData<Space>::row(Joint::slide)] = joint.direction * u[0];
      return;
    }
    default:
      break;
  }
  if constexpr (Space::angular == 3) {
    HingeMotion m;
    m.H.resize(6, static_cast<Eigen::Index>(joint.speeds));
    joint.hinge->motion({x, joint.positions}, {u, joint.speeds}, m);
    out.SM = Space::compose(joint.F, {m.pose.R, m.pose.p});
    out.rate = m.H * Eigen::Map<const Eigen::VectorXd>(u, m.H.cols());
    out.bias = m.bias;
  }
}

/// Whether the hinge has one rate along one row of the twist.
constexpr bool single(Joint kind) { return kind == Joint::rotate || kind == Joint::slide; }

}  // namespace withy::sweep
