#include <gmock/gmock.h>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/stop.hpp"
#include "withy/tests/simulation/oscillator.hpp"

namespace withy {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// M = diag(4, m(q)): the mode's mass depends on its deflection as in a strict truncation.
FunctionEquations with_modal_mass(const Model& model, std::function<double(double q)> mass, double force) {
  FunctionEquations e = boom_equations(model, [mass, force](double, double q, double) { return force / mass(q); });
  e.system_ = [mass](double, std::span<const double> y) {
    return DenseSystem{2, {4, 0, 0, mass(y[1])}, {0, 0}, {0, 0}};
  };
  return e;
}

// (1 − 4q) q̈ = 1: det M falls to zero at q = 1/4, where q̈ becomes infinite. From rest q̇² = −½ ln(1 − 4q).
TEST(MassMatrix, a_run_that_ends_where_det_m_vanishes_is_singular_and_says_so) {
  const Model model = boom();
  const FunctionEquations equations = with_modal_mass(
      model, [](double q) { return 1 - 4 * q; }, 1);
  for (const char* id : {"dopri5", "rk4-adaptive"}) {
    Runner run(until(5, 0.01), make_integrator(id, {}));
    const RunSummary summary = run(model, equations, boom_state(0, 0));
    ASSERT_NE(summary.status, RunStatus::completed);
    EXPECT_NEAR(summary.final.y[1], 0.25, 1e-3);
    EXPECT_THAT(summary.message, AllOf(HasSubstr("100 % modes of 'boom'"), HasSubstr("det M")));
    EXPECT_GT(summary.conditioning.condition, 1e3);
    EXPECT_GT(std::abs(summary.conditioning.weakest[1]), 0.999);
  }
}

// The force vanishes with the mass, so that the motion, q = t, goes through; equations that turn indefinite are not the
// model's all the same, and the run ends at the step that found it.
TEST(MassMatrix, a_change_of_sign_ends_the_run_where_the_motion_would_go_through) {
  const Model model = boom();
  FunctionEquations equations = with_modal_mass(
      model, [](double q) { return 1 - 4 * q; }, 0);
  Runner run(until(1, 0.01), make_integrator("dopri5", {{"max_step", Value(0.01)}}));
  const RunSummary summary = run(model, equations, boom_state(0, 0, 0, 1));
  EXPECT_EQ(summary.status, RunStatus::singular);
  EXPECT_EQ(summary.conditioning.determinant_sign, -1);
  EXPECT_THAT(summary.message, AllOf(HasSubstr("the determinant of the mass matrix changed its sign"),
                                     HasSubstr("the direction of negative mass is 100 % modes of 'boom'")));
  const std::size_t at = summary.message.find("det M changed sign between t = ");
  ASSERT_NE(at, std::string::npos) << summary.message;
  double before = 0, after = 0;
  ASSERT_EQ(std::sscanf(summary.message.c_str() + at, "det M changed sign between t = %lf and %lf s", &before, &after),
            2);
  EXPECT_LE(before, 0.25);
  EXPECT_GE(after, 0.25);
  EXPECT_LE(after - before, 0.01 + 2e-4) << "a step, told to four digits, rounded outward";
  EXPECT_NEAR(summary.reached, after, 1e-4) << "printed with four digits";
}

TEST(MassMatrix, definiteness_is_lost_by_sign_eigenvalue_or_condition) {
  MassMatrixHistory history;
  history.start = {.condition = 1e3, .determinant_sign = 1, .smallest_eigenvalue = 1, .weakest = {1}};
  history.end = history.start;
  EXPECT_FALSE(history.lost_definiteness());
  history.end.determinant_sign = -1;
  EXPECT_TRUE(history.lost_definiteness());
  history.end = history.start;
  history.end.smallest_eigenvalue = -1e-3;  // two eigenvalues may have changed sign together, and det M not
  EXPECT_TRUE(history.lost_definiteness());
  history.end = history.start;
  history.end.condition = 1e15;
  EXPECT_TRUE(history.became_singular());
  EXPECT_TRUE(history.lost_definiteness());
  history.start.condition = 9e14;  // bodies of very different mass: nothing happened on the way
  EXPECT_FALSE(history.lost_definiteness());
  history.change = {0.1, 0.2};
  EXPECT_TRUE(history.lost_definiteness());
}

// Of a matrix that is not symmetric the determinant decides: one of the motions has negative inertia where it is < 0.
TEST(MassMatrix, that_was_never_definite_is_not_acquitted) {
  const Layout layout = boom().layout();
  const auto told = [&](const std::vector<double>& mass) {
    Stop stop{RunStatus::diverged, "it grows"};
    MassMatrixHistory h;
    h.first = h.last = {2, mass, {}, {}};
    h.start = h.end = conditioning(h.last);
    return explain(stop, 1, &h, layout);
  };
  EXPECT_THAT(told({1, 0.5, 0, -0.1}), HasSubstr("as it was at the start: some motion has negative inertia"));
  // An indefinite symmetric part says little where the determinant is positive, but M is no structure's either.
  EXPECT_THAT(told({1, 3, 0, 1}), HasSubstr("The mass matrix is indefinite as it was at the start"));
  EXPECT_THAT(told({1, 0.5, 0.5, 1}), HasSubstr("The mass matrix is not the reason"));
}

// The mode's inertia falls to 1e-14 of what it was, the hinge's is 4 throughout. In inches instead of metres the mode's
// entry is 39.37^-2 as large at all times; the direction stays the mode's.
TEST(MassMatrix, the_direction_of_least_mass_does_not_depend_on_units) {
  const Layout layout = boom().layout();
  for (const double unit : {1.0, 1 / 39.37, 1e6}) {
    MassMatrixHistory h;
    h.first = {2, {4, 0.1 * unit, 0.1 * unit, 2 * unit * unit}, {}, {}};
    h.last = {2, {4, 0, 0, 2e-14 * unit * unit}, {}, {}};
    h.start = conditioning(h.first);
    h.end = conditioning(h.last);
    EXPECT_THAT(describe(h, layout), HasSubstr("the direction of least mass is 100 % modes of 'boom'.")) << unit;
  }
}

TEST(MassMatrix, sign_of_the_determinant_survives_overflow_and_permutation) {
  const std::size_t n = 400;
  DenseSystem system{n, std::vector<double>(n * n), {}, {}};
  for (std::size_t i = 0; i < n; ++i) system.mass[i * n + i] = 1e5;  // det = 1e2000
  EXPECT_EQ(determinant_sign(system), 1);
  system.mass[0] = -1e5;
  EXPECT_EQ(determinant_sign(system), -1);
  EXPECT_EQ(determinant_sign({2, {0, 1, 1, 0}, {}, {}}), -1);
  EXPECT_EQ(determinant_sign({2, {1, 1, 1, 1}, {}, {}}), 0);
}

}  // namespace
}  // namespace withy
