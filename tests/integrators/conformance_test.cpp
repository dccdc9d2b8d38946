#include "withy/tests/conformance/adaptive_integrator_suite.hpp"
#include "withy/tests/conformance/integrator_suite.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

auto uncontrolled(std::string id) {
  return [id](double step) { return make_uncontrolled(id, step); };
}

auto equal_steps(std::string id) {
  return [id](double step) { return make_integrator(id, {{"step", Value(step)}}); };
}

constexpr double unlimited = std::numeric_limits<double>::infinity();

auto controlled(std::string id) {
  return [id](double tolerance, double first_step) {
    std::vector<Value::Member> given{{"rtol", Value(tolerance)}, {"atol", Value(tolerance)}};
    if (first_step > 0) given.emplace_back("initial_step", Value(first_step));
    return make_integrator(id, std::move(given));
  };
}

// Limits on the imaginary axis, beyond which |R(iy)| > 1. rk4: 2√2 (Hairer & Wanner, Solving ODEs II, IV.2). dopri5:
// 0.997, root of |1 + z + … + z⁵/120 + z⁶/600| = 1. rk4-adaptive: R(z) = (16 R₄(z/2)² − R₄(z))/15 with R₄ that of rk4;
// the greatest root of |R| = 1 is 4.8224. (Below the root 2.4926 it grows a little, by at most 0.43 % a step: an error
// that the error control sees.) dop853: 5.9604, root of |R| = 1 of its stability polynomial, computed from its tableau.
INSTANTIATE_TEST_SUITE_P(Withy, IntegratorSuite,
                         testing::Values(IntegratorCase{"rk4", equal_steps("rk4"), 4, 2.8284},
                                         IntegratorCase{"rk4_adaptive", uncontrolled("rk4-adaptive"), 5, 4.8224},
                                         IntegratorCase{"dopri5", uncontrolled("dopri5"), 5, 0.997},
                                         IntegratorCase{"dop853", uncontrolled("dop853"), 8, 5.9604, 8},
                                         IntegratorCase{"rosenbrock_w", uncontrolled("rosenbrock-w"), 3, unlimited},
                                         IntegratorCase{"imex", uncontrolled("imex"), 4, unlimited, 4},
                                         IntegratorCase{"radau", uncontrolled("radau"), 4, unlimited, 4},
                                         IntegratorCase{"gauss", equal_steps("gauss"), 4, unlimited, 4},
                                         IntegratorCase{"generalized_alpha", equal_steps("generalized-alpha"), 2,
                                                        unlimited}),
                         integrator_case_name);

INSTANTIATE_TEST_SUITE_P(Withy, AdaptiveIntegratorSuite,
                         testing::Values(AdaptiveIntegratorCase{"rk4_adaptive", controlled("rk4-adaptive")},
                                         AdaptiveIntegratorCase{"dopri5", controlled("dopri5")},
                                         AdaptiveIntegratorCase{"dop853", controlled("dop853")},
                                         AdaptiveIntegratorCase{"imex", controlled("imex")},
                                         AdaptiveIntegratorCase{"radau", controlled("radau")}),
                         adaptive_case_name);

}  // namespace
}  // namespace withy
