#include <algorithm>

#include "withy/core/tangents/recursion_members.hpp"

namespace withy::analysis {
namespace {

/// Magnitudes of what a body needs: its forces, their moments about its frame's origin, and what they do to its modes.
struct Size {
  double force = 0, moment = 0;
  Eigen::VectorXd modes;

  /// A force and a moment at a point that moves with the modes as P and W say.
  template <class Motion>
  void add(double f, double n, double arm, const Motion& m) {
    force += f;
    moment += n + arm * f;
    act(f, n, m);
  }
  template <class Motion>
  void act(double f, double n, const Motion& m) {
    modes += f * m.P.colwise().norm().transpose();
    if (n > 0) modes += n * m.W.colwise().norm().transpose();
  }
};

/// Bounds of the terms of force_on and moment_on [N, N m], whatever their directions: what turns about an axis of its
/// own needs none, but rounding of the axis's direction is to be seen against what others would. \param carried
/// acceleration of the body's frame, bounded likewise
double bound_of_force(const Turning<double>& t, double carried, const PointMotionOf<double>& m, double mass,
                      const Eigen::VectorXd& q_ddot) {
  return mass * (carried + t.turn.norm() * m.r.norm() + t.twice.norm() * m.r_rate.norm() + m.r_bias.norm() +
                 (m.P * q_ddot).norm());
}

double bound_of_moment(const Turning<double>& t, const PointMotionOf<double>& m, const Matrix3& inertia,
                       const Eigen::VectorXd& q_ddot) {
  const double w = t.w.norm() + m.w_rate.norm();
  return inertia.norm() * (t.alpha.norm() + w * w + m.w_bias.norm() + (m.W * q_ddot).norm());
}

}  // namespace

Eigen::VectorXd sizes_of(const Recursion<double>& tree, const std::vector<AppliedWrench<double>>& wrenches) {
  const Layout& layout = tree.model_.layout();
  const auto& frames = tree.frames_;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(layout.speeds));
  std::vector<Size> all(frames.size());
  std::vector<double> carried(frames.size()), turn(frames.size());
  for (std::size_t b = 0; b < frames.size(); ++b) {
    const Eigen::VectorXd& q_ddot = tree.states_[b].q_ddot;
    const Turning<double> t = tree.turning(b);
    turn[b] = t.turn.norm();
    carried[b] = t.a.norm();
    if (const int parent = tree.model_.hinges()[b].parent; parent >= 0) {
      const auto p = static_cast<std::size_t>(parent);
      carried[b] = std::max(carried[b], carried[p] + turn[p] * (frames[b].p - frames[p].p).norm());
    }
    all[b].modes = Eigen::VectorXd::Zero(q_ddot.size());
    tree.for_mass(
        b,
        [&](const PointMotionOf<double>& m, double mass) {
          all[b].add(bound_of_force(t, carried[b], m, mass, q_ddot), 0, m.r.norm(), m);
        },
        [&](const PointMotionOf<double>& m, const Matrix3& inertia) {
          all[b].add(0, bound_of_moment(t, m, inertia, q_ddot), 0, m);
        });
  }
  for (const AppliedWrench<double>& w : wrenches) {
    const PointMotionOf<double> m = tree.relative(w.at.body, w.at.frame, Pose{});
    all[static_cast<std::size_t>(w.at.body)].add(w.force.norm(), w.moment.norm(), m.r.norm(), m);
  }
  for (std::size_t b = frames.size(); b-- > 0;) {
    Size& size = all[b];
    const Vector3& at = tree.hinge_frames_[b].p;
    const double moment = size.moment + (at - frames[b].p).norm() * size.force;
    size.act(size.force, moment, tree.child_[b]);
    if (size.modes.size() > 0)
      result.segment(static_cast<Eigen::Index>(layout.modes(b)->speed), size.modes.size()) = size.modes;
    const Slot& slot = layout.hinges[b];
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& H = tree.hinges_[b].H;
    result.segment(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speeds)) =
        moment * H.topRows<3>().colwise().norm().transpose() +
        size.force * H.bottomRows<3>().colwise().norm().transpose();
    const HingeNode& h = tree.model_.hinges()[b];
    if (h.parent < 0) continue;
    const auto p = static_cast<std::size_t>(h.parent);
    const Vector3 arm = frames[p].R * tree.parent_[b].r;
    const double about_outer = moment + (at - frames[p].p - arm).norm() * size.force;
    all[p].add(size.force, about_outer, arm.norm(), tree.parent_[b]);
  }
  return result;
}

template class Recursion<double>;
template class Recursion<Jet>;

}  // namespace withy::analysis
