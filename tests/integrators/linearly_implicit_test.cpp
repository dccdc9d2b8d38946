/// \file
/// The linearly implicit methods on a pendulum that drives a stiff oscillator: x'' = −sin x + q/10, q'' = −k q + sin x.
/// They are told of the oscillator's stiffness alone, not of the pendulum's: the order must not depend on that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "withy/tests/conformance/function_equations.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

FunctionEquations stiff_pair(double k) {
  FunctionEquations e(2, 2, [k](double, std::span<const double> y, std::span<double> d) {
    d[0] = y[2];
    d[1] = y[3];
    d[2] = -std::sin(y[0]) + 0.1 * y[1];
    d[3] = -k * y[1] + std::sin(y[0]);
    d[4] = 0;
    return Evaluation{};
  });
  e.stiffness_ = {0, k};
  return e;
}

class LinearlyImplicitMethods : public testing::TestWithParam<std::string> {
 protected:
  static std::vector<double> run(const EquationsOfMotion& equations, double step, double end) {
    const auto integrator = make_uncontrolled(GetParam(), step);
    const auto stepper = integrator->start(equations, State{0, {1, 0, 0, 0, 0}});
    while (stepper->state().time < end) EXPECT_EQ(stepper->step(end).outcome, StepResult::Outcome::ok);
    return stepper->state().y;
  }
};
std::string method_name(const testing::TestParamInfo<std::string>& info) {
  return info.param == "imex" ? "imex" : "rosenbrock_w";
}
INSTANTIATE_TEST_SUITE_P(Withy, LinearlyImplicitMethods, testing::Values("rosenbrock-w", "imex"), method_name);

// With k = 4 nothing is stiff: half the step, an error smaller by 2^order.
TEST_P(LinearlyImplicitMethods, have_their_order_when_told_of_a_part_of_the_stiffness) {
  const FunctionEquations equations = stiff_pair(4);
  const int order = make_uncontrolled(GetParam(), 1)->order();
  const double longest = order > 3 ? 0.16 : 0.04;
  const std::vector<double> exact = run(equations, longest / 400, 2);
  std::vector<double> errors;
  for (int i = 0; i < 4; ++i) errors.push_back(std::abs(run(equations, longest / (1 << i), 2)[0] - exact[0]));
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_NEAR(std::log2(errors[i - 1] / errors[i]), order, 0.25);
}

// Steps a thousand times longer than an explicit method could take (hω = 1000): the pendulum stays right to the
// method's own accuracy, and the oscillator follows it quasi-statically, q = sin x / k.
TEST_P(LinearlyImplicitMethods, step_over_frequencies_they_do_not_resolve) {
  const double k = 1e10;
  const std::vector<double> y = run(stiff_pair(k), 0.01, 2);
  const std::vector<double> reference = run(stiff_pair(k), 0.0005, 2);
  EXPECT_NEAR(y[0], reference[0], 1e-6);
  EXPECT_NEAR(y[1] * k, std::sin(y[0]), 1e-3);
}

/// Equations that offer no linear solution, as those of the strict formulations.
class Plain final : public FunctionEquations {
 public:
  using FunctionEquations::FunctionEquations;
  const LinearlyImplicit* linearly_implicit() const override { return nullptr; }
};

TEST_P(LinearlyImplicitMethods, refuse_equations_that_offer_no_linear_solution) {
  const Plain plain(1, 1, [](double, std::span<const double>, std::span<double> d) {
    d[0] = d[1] = d[2] = 0;
    return Evaluation{};
  });
  const auto integrator = make_integrator(GetParam(), {});
  EXPECT_THAT(
      [&] {
        (void)integrator->start(plain, State{0, {0, 0, 0}});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::AllOf(
          testing::HasSubstr("'" + GetParam() + "'"), testing::HasSubstr("strict formulations have none"))));
}

// From the second step on the interpolant is as good as the method.
TEST(Imex, interpolates_to_its_own_order_once_it_has_a_step_behind_it) {
  const auto greatest_inside = [](double h) {
    const FunctionEquations equations = Duffing::equations();
    const auto stepper = make_uncontrolled("imex", h)->start(equations, Duffing::start());
    double greatest = 0;
    std::vector<double> y(3);
    drive(*stepper, h);
    while (stepper->state().time < 4) {
      const double before = stepper->state().time;
      drive(*stepper, std::min(before + h, 4.0));
      for (int i = 1; i < 8; ++i) {
        const double t = before + i / 8.0 * (stepper->state().time - before);
        stepper->interpolate(t, y);
        greatest = std::max(greatest, Duffing::error(t, y));
      }
    }
    return greatest;
  };
  EXPECT_GT(std::log2(greatest_inside(0.1) / greatest_inside(0.05)), 4.8);
}

// The mass matrix of q, m = 2 + cos x, swings with the pendulum, x = t: the part of ẏ that is stiff varies within a
// step, and the method must not multiply the variation by the stiffness. Exact: q = sin t/k (1 + O(1/k)).
TEST(Imex, takes_the_mass_matrix_at_each_stage) {
  constexpr double k = 1e8;
  class Swinging final : public FunctionEquations {
   public:
    Swinging() : FunctionEquations(2, 2, &rate) {}
    static double mass(std::span<const double> y) { return 2 + std::cos(y[0]); }
    static Evaluation rate(double, std::span<const double> y, std::span<double> d) {
      d[0] = y[2];
      d[1] = y[3];
      d[2] = d[4] = 0;
      d[3] = (std::sin(y[0]) - k * y[1]) / mass(y);
      return {};
    }
    Evaluation implicit_derivatives(double t, std::span<const double> y, std::span<const double> base, double delta,
                                    std::span<double> d, Work&) const noexcept override {
      rate(t, y, d);
      const double m = mass(y);
      d[3] = (m * d[3] + k * (y[1] - base[1] - delta * base[3])) / (m + delta * delta * k);
      d[1] = base[3] + delta * d[3];
      return {};
    }
  };
  const auto integrator = make_uncontrolled("imex", 0.1);
  const Swinging equations;
  const auto stepper = integrator->start(equations, State{0, {0, 0, 1, 1 / k, 0}});
  for (double t = 0.5; t < 6; t += 0.5) {
    ASSERT_EQ(drive(*stepper, t).outcome, StepResult::Outcome::ok);
    EXPECT_NEAR(stepper->state().y[1] * k, std::sin(t), 1e-4) << t;
  }
}

}  // namespace
}  // namespace withy
