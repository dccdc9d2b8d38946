/// \file
/// Feedback through the inverse dynamics of the rigid tree (computed torque; Luh, Walker & Paul 1980):
///   τ = ID(x, ẋ, a),   a = ẍ_r + 2 ζ ω (ẋ_r − ẋ) + ω² (x_r − x),
/// at the actual coordinates and rates of the hinges. On a rigid tree the error e = x_r − x obeys ë + 2 ζ ω ė + ω² e =
/// 0.
#include <algorithm>

#include "withy/core/plugin/registry.hpp"
#include "withy/core/sweep/rigid_inverse_dynamics.hpp"
#include "withy/loads/sampled.hpp"

namespace withy {
namespace {

struct Feedback {
  double bandwidth = 0;      ///< ω [rad/s]
  double damping_ratio = 0;  ///< ζ
  bool begins_on = true;     ///< the motion begins on the trajectories
};

class BoundComputedTorque final : public TrackingLoad {
 public:
  BoundComputedTorque(const Model& model, const std::vector<FollowedHinge>& hinges, const Feedback& feedback)
      : TrackingLoad(model, rates_of(hinges), axes_of(model, hinges)),
        dynamics_(model),
        positions_(model.layout().positions),
        speeds_(model.layout().speeds),
        feedback_(feedback) {}

  std::size_t scratch() const override { return 2 * speeds_ + dynamics_.scratch(); }
  void add(double t, std::span<const double> positions, std::span<const double> speeds, std::span<double> efforts,
           std::span<double> scratch) const noexcept override {
    const std::span<const double> tau = torques(t, positions, speeds, scratch);
    for (const FollowedAxis& axis : axes()) efforts[axis.speed] += tau[axis.speed];
  }
  void commands(double t, std::span<const double> positions, std::span<const double> speeds, std::span<double> values,
                std::span<double> scratch) const noexcept override {
    const std::span<const double> tau = torques(t, positions, speeds, scratch);
    for (std::size_t i = 0; i < axes().size(); ++i) values[i] = tau[axes()[i].speed];
  }
  void begin(State& state) const override {
    if (feedback_.begins_on) begin_on(axes(), positions_, state);
  }

 private:
  /// Of the whole inverse dynamics, in the scratch space.
  [[nodiscard]] std::span<const double> torques(double t, std::span<const double> positions,
                                                std::span<const double> speeds,
                                                std::span<double> scratch) const noexcept {
    const auto u_dot = scratch.first(speeds_);
    const auto tau = scratch.subspan(speeds_, speeds_);
    std::fill(u_dot.begin(), u_dot.end(), 0.0);
    for (const FollowedAxis& axis : axes()) {
      const MotionPoint r = at(axis.trajectory, t);
      const double w = feedback_.bandwidth;
      u_dot[axis.speed] = r.acceleration + 2 * feedback_.damping_ratio * w * (r.rate - speeds[axis.speed]) +
                          w * w * (r.position - positions[axis.position]);
    }
    dynamics_.efforts(positions, speeds, u_dot, tau, scratch.subspan(2 * speeds_));
    return tau;
  }

  RigidInverseDynamics dynamics_;
  std::size_t positions_;
  std::size_t speeds_;
  Feedback feedback_;
};

class ComputedTorque final : public Load {
 public:
  /// \param period [s] between samples; 0: continuous
  ComputedTorque(std::vector<FollowedHinge> hinges, const Feedback& feedback, double period)
      : hinges_(std::move(hinges)), feedback_(feedback), period_(period) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return sampled(std::make_unique<BoundComputedTorque>(model, hinges_, feedback_), period_);
  }

 private:
  std::vector<FollowedHinge> hinges_;
  Feedback feedback_;
  double period_;
};

std::unique_ptr<Load> make_computed_torque(const Value& p, const MakeContext& context) {
  auto hinges = TrajectoryReader(p, context).read();
  if (!hinges) return nullptr;
  return std::make_unique<ComputedTorque>(
      std::move(*hinges),
      Feedback{p.number_at("bandwidth"), p.number_at("damping_ratio"), p.text_at("law") != "constant"},
      sample_period(p));
}

}  // namespace

void enroll_computed_torque(Enrollment& enrollment) {
  std::vector<ParameterSpec> parameters =
      trajectory_parameters({"quintic", "bang-bang", "table", "sine", "constant"}, {},
                            "hinges to control, of one coordinate each; of the others no acceleration is expected");
  parameters.push_back(number("bandwidth", "rad/s", "natural frequency of the error of a rigid tree").above(0));
  parameters.push_back(number("damping_ratio", "1", "damping ratio of the error").least(0).otherwise(1.0));
  parameters.push_back(sample_parameter());
  enrollment.add<Load>({.id = "computed-torque",
                        .summary = "Controller: feedback through the inverse dynamics of the tree of rigid bodies",
                        .parameters = std::move(parameters),
                        .make = &make_computed_torque});
}

}  // namespace withy
