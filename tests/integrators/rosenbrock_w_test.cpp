/// \file
/// The linearly implicit method on a pendulum that drives a stiff oscillator: x'' = −sin x + q/10, q'' = −k q + sin x.
/// A holds the oscillator's stiffness alone, not the pendulum's: the order must not depend on that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "withy/tests/conformance/function_equations.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

class StiffPair final : public FunctionEquations, public LinearlyImplicit {
 public:
  explicit StiffPair(double k)
      : FunctionEquations(2, 2,
                          [k](double, std::span<const double> y, std::span<double> d) {
                            d[0] = y[2];
                            d[1] = y[3];
                            d[2] = -std::sin(y[0]) + 0.1 * y[1];
                            d[3] = -k * y[1] + std::sin(y[0]);
                            d[4] = 0;
                            return Evaluation{};
                          }),
        k_(k) {}
  const LinearlyImplicit* linearly_implicit() const override { return this; }
  Work make_factors() const override { return Work(64); }
  Evaluation factorize(std::span<const double>, double delta, Work& factors) const noexcept override {
    *reinterpret_cast<double*>(factors.data()) = delta;
    return {};
  }
  void solve(std::span<double> r, Work& factors) const noexcept override {
    const double delta = *reinterpret_cast<const double*>(factors.data());
    r[3] = (r[3] - delta * k_ * r[1]) / (1 + delta * delta * k_);
    r[1] += delta * r[3];
  }

 private:
  double k_;
};

std::vector<double> run(const EquationsOfMotion& equations, double step, double end) {
  const auto integrator = make_uncontrolled("rosenbrock-w", step);
  const auto stepper = integrator->start(equations, State{0, {1, 0, 0, 0, 0}});
  while (stepper->state().time < end) EXPECT_EQ(stepper->step(end).outcome, StepResult::Outcome::ok);
  return stepper->state().y;
}

// With k = 4 nothing is stiff and the error is that of a third-order method: 8 times smaller for half the step.
TEST(RosenbrockW, has_order_three_with_a_jacobian_of_the_stiffness_alone) {
  const StiffPair equations(4);
  const std::vector<double> exact = run(equations, 1e-4, 2);
  std::vector<double> errors;
  for (const double step : {0.04, 0.02, 0.01, 0.005}) errors.push_back(std::abs(run(equations, step, 2)[0] - exact[0]));
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), 3.0, 0.25);
}

// Steps a thousand times longer than an explicit method could take (hω = 1000): the pendulum stays right to the
// method's own accuracy, and the oscillator follows it quasi-statically, q = sin x / k.
TEST(RosenbrockW, steps_over_frequencies_it_does_not_resolve) {
  const double k = 1e10;
  const std::vector<double> y = run(StiffPair(k), 0.01, 2);
  const std::vector<double> reference = run(StiffPair(k), 0.0005, 2);
  EXPECT_NEAR(y[0], reference[0], 1e-6);
  EXPECT_NEAR(y[1] * k, std::sin(y[0]), 1e-3);
}

TEST(RosenbrockW, refuses_equations_that_offer_no_linear_solution) {
  const FunctionEquations plain(1, 1, [](double, std::span<const double>, std::span<double> d) {
    d[0] = d[1] = d[2] = 0;
    return Evaluation{};
  });
  const auto integrator = make_integrator("rosenbrock-w", {});
  EXPECT_THAT(
      [&] {
        (void)integrator->start(plain, State{0, {0, 0, 0}});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("strict formulations have none")));
}

}  // namespace
}  // namespace withy
