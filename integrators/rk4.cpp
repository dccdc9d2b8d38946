/// \file
/// The classical Runge–Kutta method of order 4 with equal steps; interpolation is cubic Hermite.
#include "equal_steps.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

/// The method with the slope at the end of its step, for equations that make whole steps.
constexpr StageTable whole_rk4 = [] {
  StageTable table;
  table.stages = 5;
  table.c = {0, 0.5, 0.5, 1, 1};
  table.a[1] = {0.5};
  table.a[2] = {0, 0.5};
  table.a[3] = {0, 0, 1};
  table.a[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  return table;
}();

class Rk4Stepper final : public EqualSteps {
 public:
  Rk4Stepper(const EquationsOfMotion& equations, const State& start, double step)
      : EqualSteps(equations, start, step), stage_(size()), k2_(size()), k3_(size()), k4_(size()) {}

 private:
  Evaluation attempt(double h) override {
    if (staged()) return whole_step(whole_rk4, h, std::array<std::span<double>, 3>(), ends_of(h));
    const double t = state_.time;
    const Eigen::ArrayXd& k1 = slope_;
    if (const Evaluation e = evaluate(t + h / 2, stage_ = y() + h / 2 * k1, k2_); !e.ok()) return e;
    if (const Evaluation e = evaluate(t + h / 2, stage_ = y() + h / 2 * k2_, k3_); !e.ok()) return e;
    if (const Evaluation e = evaluate(t + h, stage_ = y() + h * k3_, k4_); !e.ok()) return e;
    next_ = y() + h / 6 * (k1 + 2 * k2_ + 2 * k3_ + k4_);
    normalize(next_);
    return evaluate(t + h, next_, next_slope_);
  }

  void inside(double theta, Values values) const override { cubic(theta, values); }

  Eigen::ArrayXd stage_, k2_, k3_, k4_;
};

class Rk4 final : public Integrator {
 public:
  explicit Rk4(double step) : step_(step) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<Rk4Stepper>(equations, state, step_);
  }
  int order() const override { return 4; }
  std::optional<double> stability_limit() const override { return 2.832; }

 private:
  double step_;
};

}  // namespace

void enroll_rk4(Enrollment& enrollment) {
  enrollment.add<Integrator>({.id = "rk4",
                              .summary = "Classical Runge-Kutta method of order 4, equal steps",
                              .parameters = {step_parameter()},
                              .make = [](const Value& p, const MakeContext&) -> std::unique_ptr<Integrator> {
                                return std::make_unique<Rk4>(p.number_at("step"));
                              }});
}

}  // namespace withy
