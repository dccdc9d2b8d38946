/// \file
/// Open-loop efforts from the inverse dynamics of the rigid tree along a trajectory.
#include "withy/core/sweep/rigid_inverse_dynamics.hpp"

#include <algorithm>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/tracking.hpp"

namespace withy {
namespace {

class BoundSlew final : public TrackingLoad {
 public:
  BoundSlew(const Model& model, const std::vector<FollowedHinge>& hinges)
      : TrackingLoad(model, rates_of(hinges), axes_of(model, hinges)),
        dynamics_(model),
        positions_(model.layout().positions),
        speeds_(model.layout().speeds) {
    reference_ = model.reference_state().y;
    reference_.resize(positions_);
  }

  std::size_t scratch() const override { return positions_ + 3 * speeds_ + dynamics_.scratch(); }
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> scratch) const noexcept override {
    const std::span<const double> tau = torques(t, scratch);
    for (const FollowedAxis& axis : axes()) efforts[axis.speed] += tau[axis.speed];
  }
  void commands(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                std::span<double> values, std::span<double> scratch) const noexcept override {
    const std::span<const double> tau = torques(t, scratch);
    for (std::size_t i = 0; i < axes().size(); ++i) values[i] = tau[axes()[i].speed];
  }

  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // a function of time alone
  }
  void begin(State& state) const override { begin_on(axes(), positions_, state); }

 private:
  /// Of the whole inverse dynamics along the trajectories, in the scratch space.
  [[nodiscard]] std::span<const double> torques(double t, std::span<double> scratch) const noexcept {
    const auto x = scratch.first(positions_);
    const auto u = scratch.subspan(positions_, speeds_);
    const auto u_dot = scratch.subspan(positions_ + speeds_, speeds_);
    const auto tau = scratch.subspan(positions_ + 2 * speeds_, speeds_);
    std::copy(reference_.begin(), reference_.end(), x.begin());
    std::fill(u.begin(), u.end(), 0.0);
    std::fill(u_dot.begin(), u_dot.end(), 0.0);
    for (const FollowedAxis& axis : axes()) {
      const MotionPoint motion = at(axis.trajectory, t);
      x[axis.position] = motion.position;
      u[axis.speed] = motion.rate;
      u_dot[axis.speed] = motion.acceleration;
    }
    dynamics_.efforts(x, u, u_dot, tau, scratch.subspan(positions_ + 3 * speeds_));
    return tau;
  }

  RigidInverseDynamics dynamics_;
  std::size_t positions_;
  std::size_t speeds_;
  std::vector<double> reference_;  ///< positions; hinges that are not moved stay there
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
