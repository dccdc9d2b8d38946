/// \file
/// An effort on one rate of a hinge as a function of time: constant, sine, table or steps.
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/timed_effort.hpp"
#include "withy/loads/hinge_rate.hpp"
#include "withy/loads/time_law.hpp"

namespace withy {
namespace {

/// The bound loads of one load share its law.
using Effort = std::shared_ptr<const TimeLaw<double>>;

class BoundHingeEffort final : public BoundLoad, public TimedEffort {
 public:
  BoundHingeEffort(Effort effort, std::size_t speed) : effort_(std::move(effort)), speed_(speed) {}
  std::size_t scratch() const override { return 0; }
  void add(double t, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> efforts, std::span<double> /*scratch*/) const noexcept override {
    efforts[speed_] += (*effort_)(t);
  }
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // a function of time alone
  }
  std::vector<double> discontinuities() const override { return effort_->discontinuities(); }
  double end() const override { return effort_->end(); }
  void begin(State& /*state*/) const override {}

  std::size_t speed() const override { return speed_; }
  double effort(double t) const noexcept override { return (*effort_)(t); }
  std::shared_ptr<const void> law() const override { return effort_; }

 private:
  Effort effort_;
  std::size_t speed_;
};

class HingeEffort final : public Load {
 public:
  HingeEffort(RateName rate, Effort effort) : rate_(std::move(rate)), effort_(std::move(effort)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundHingeEffort>(effort_, speed_index(model, rate_));
  }

 private:
  RateName rate_;
  Effort effort_;
};

std::unique_ptr<Load> make_hinge_effort(const Value& p, const MakeContext& context) {
  std::optional<TimeLaw<double>> effort = TimeLawReader<double>(p, context).read();
  if (!effort) return nullptr;
  return std::make_unique<HingeEffort>(rate_name(p), std::make_shared<const TimeLaw<double>>(std::move(*effort)));
}

}  // namespace

void enroll_hinge_effort(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-effort",
       .summary = "Effort on one rate of a hinge as a function of time; a force in N where the rate is a velocity",
       .parameters = rate_parameters(time_law_parameters<double>("effort", "N m|N")),
       .make = &make_hinge_effort});
}

}  // namespace withy
