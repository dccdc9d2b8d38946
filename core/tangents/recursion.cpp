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

}  // namespace

template <class S>
typename Recursion<S>::VX Recursion<S>::sizes(
    const std::vector<AppliedWrench<S>>& wrenches) const requires std::is_same_v<S, double> {
  const Layout& layout = model_.layout();
  VX result = VX::Zero(static_cast<Eigen::Index>(layout.speeds));
  std::vector<Size> all(frames_.size());
  for (std::size_t b = 0; b < frames_.size(); ++b) {
    const VX& q_ddot = states_[b].q_ddot;
    const Turning t = turning(b);
    all[b].modes = VX::Zero(q_ddot.size());
    for_mass(
        b,
        [&](const PointMotionOf<S>& m, double mass) {
          all[b].add(force_on(t, m, mass, q_ddot).norm(), 0, m.r.norm(), m);
        },
        [&](const PointMotionOf<S>& m, const Matrix3& inertia) {
          all[b].add(0, moment_on(t, m, inertia, q_ddot).norm(), 0, m);
        });
  }
  for (const AppliedWrench<S>& w : wrenches) {
    const PointMotionOf<S> m = relative(w.at.body, w.at.frame, Pose{});
    all[static_cast<std::size_t>(w.at.body)].add(w.force.norm(), w.moment.norm(), m.r.norm(), m);
  }
  for (std::size_t b = frames_.size(); b-- > 0;) {
    Size& size = all[b];
    const double moment = size.moment + (hinge_frames_[b].p - frames_[b].p).norm() * size.force;
    size.act(size.force, moment, child_[b]);
    if (size.modes.size() > 0)
      result.segment(static_cast<Eigen::Index>(layout.modes(b)->speed), size.modes.size()) = size.modes;
    const Slot& slot = layout.hinges[b];
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& H = hinges_[b].H;
    result.segment(static_cast<Eigen::Index>(slot.speed), static_cast<Eigen::Index>(slot.speeds)) =
        moment * H.topRows<3>().colwise().norm().transpose() +
        size.force * H.bottomRows<3>().colwise().norm().transpose();
    const HingeNode& h = model_.hinges()[b];
    if (h.parent < 0) continue;
    const auto p = static_cast<std::size_t>(h.parent);
    const V3 arm = frames_[p].R * parent_[b].r;
    const double about_outer = moment + (hinge_frames_[b].p - frames_[p].p - arm).norm() * size.force;
    all[p].add(size.force, about_outer, arm.norm(), parent_[b]);
  }
  return result;
}

template class Recursion<double>;
template class Recursion<Jet>;

}  // namespace withy::analysis
