/// \file
/// Dry friction on a rate of a hinge, made smooth: τ = −c tanh(ẋ / s).
#include <cmath>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

class BoundFriction final : public BoundLoad {
 public:
  BoundFriction(double effort, double scale, std::size_t speed) : effort_(effort), scale_(scale), speed_(speed) {}
  std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> speeds,
           std::span<double> efforts, std::span<double> /*scratch*/) const noexcept override {
    efforts[speed_] -= effort_ * std::tanh(speeds[speed_] / scale_);
  }
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> speeds,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> by_speed) const override {
    const auto i = static_cast<Eigen::Index>(speed_);
    const double share = std::tanh(speeds[speed_] / scale_);
    by_speed(i, i) -= effort_ / scale_ * (1 - share * share);
    return true;
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State& /*state*/) const override {}

 private:
  double effort_;  ///< c [N m, N]
  double scale_;   ///< s [rad/s, m/s]
  std::size_t speed_;
};

class HingeFriction final : public Load {
 public:
  HingeFriction(RateName rate, double effort, double scale) : rate_(std::move(rate)), effort_(effort), scale_(scale) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundFriction>(effort_, scale_, speed_index(model, rate_));
  }

 private:
  RateName rate_;
  double effort_;
  double scale_;
};

std::unique_ptr<Load> make_hinge_friction(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<HingeFriction>(rate_name(p), p.number_at("effort"), p.number_at("rate_scale"));
}

}  // namespace

void enroll_hinge_friction(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-friction",
       .summary = "Dry friction on a rate of a hinge, smooth through zero",
       .parameters = rate_parameters(
           {number("effort", "N m|N", "friction of a fast motion; a force in N where the rate is a velocity").least(0),
            number("rate_scale", "rad/s|m/s", "rate at which 76 % of it act: below, the hinge creeps").above(0)}),
       .make = &make_hinge_friction});
}

}  // namespace withy
