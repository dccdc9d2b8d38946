/// \file
/// Open-loop efforts from the inverse dynamics of the rigid tree along a trajectory.
#include "withy/core/sweep/rigid_inverse_dynamics.hpp"

#include <algorithm>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/followed_hinges.hpp"

namespace withy {
namespace {

class BoundSlew final : public BoundLoad {
 public:
  BoundSlew(const Model& model, const std::vector<FollowedHinge>& hinges)
      : dynamics_(model), positions_(model.layout().positions), speeds_(model.layout().speeds) {
    for (const FollowedHinge& h : hinges) axes_.push_back(single_axis(model, h.hinge, h.trajectory));
    reference_ = model.reference_state().y;
    reference_.resize(positions_);
  }

  std::size_t scratch() const override { return positions_ + 3 * speeds_ + dynamics_.scratch(); }
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> scratch) const noexcept override {
    const auto x = scratch.first(positions_);
    const auto u = scratch.subspan(positions_, speeds_);
    const auto u_dot = scratch.subspan(positions_ + speeds_, speeds_);
    const auto tau = scratch.subspan(positions_ + 2 * speeds_, speeds_);
    std::copy(reference_.begin(), reference_.end(), x.begin());
    std::fill(u.begin(), u.end(), 0.0);
    std::fill(u_dot.begin(), u_dot.end(), 0.0);
    for (const FollowedAxis& axis : axes_) {
      const MotionPoint motion = at(axis.trajectory, t);
      x[axis.position] = motion.position;
      u[axis.speed] = motion.rate;
      u_dot[axis.speed] = motion.acceleration;
    }
    dynamics_.efforts(x, u, u_dot, tau, scratch.subspan(positions_ + 3 * speeds_));
    for (const FollowedAxis& axis : axes_) efforts[axis.speed] += tau[axis.speed];
  }

  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // a function of time alone
  }
  std::vector<double> discontinuities() const override { return jumps_of(axes_); }
  double end() const override { return end_of(axes_); }
  void begin(State& state) const override { begin_on(axes_, positions_, state); }

 private:
  RigidInverseDynamics dynamics_;
  std::size_t positions_;
  std::size_t speeds_;
  std::vector<double> reference_;  ///< positions; hinges that are not moved stay there
  std::vector<FollowedAxis> axes_;
};

class Slew final : public Load {
 public:
  explicit Slew(std::vector<FollowedHinge> hinges) : hinges_(std::move(hinges)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundSlew>(model, hinges_);
  }

 private:
  std::vector<FollowedHinge> hinges_;
};

std::unique_ptr<Load> make_rigid_inverse_dynamics(const Value& p, const MakeContext& context) {
  auto hinges = TrajectoryReader(p, context).read();
  if (!hinges) return nullptr;
  return std::make_unique<Slew>(std::move(*hinges));
}

}  // namespace

void enroll_rigid_inverse_dynamics(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "rigid-inverse-dynamics",
                        .summary = "Open-loop efforts that would carry the tree of rigid bodies along a trajectory",
                        .parameters = trajectory_parameters(
                            {"quintic", "bang-bang", "table", "sine"}, {},
                            "hinges to move, of one coordinate each; the others count as held at their reference"),
                        .make = &make_rigid_inverse_dynamics});
}

}  // namespace withy
