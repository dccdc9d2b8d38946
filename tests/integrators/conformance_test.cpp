#include "withy/tests/conformance/adaptive_integrator_suite.hpp"
#include "withy/tests/conformance/integrator_suite.hpp"
#include "withy/tests/integrators/integrator_plugins.hpp"

namespace withy {
namespace {

std::unique_ptr<Integrator> rk4(double step) { return make_integrator("rk4", {{"step", Value(step)}}); }

/// Error control that accepts every step: equal steps.
auto uncontrolled(std::string id) {
  return [id](double step) {
    return make_integrator(
        id, {{"rtol", Value(1.0)}, {"atol", Value(1e300)}, {"initial_step", Value(step)}, {"max_step", Value(step)}});
  };
}

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
                         testing::Values(IntegratorCase{"rk4", rk4, 4, 2.8284},
                                         IntegratorCase{"rk4_adaptive", uncontrolled("rk4-adaptive"), 5, 4.8224},
                                         IntegratorCase{"dopri5", uncontrolled("dopri5"), 5, 0.997},
                                         IntegratorCase{"dop853", uncontrolled("dop853"), 8, 5.9604, 8}),
                         integrator_case_name);

INSTANTIATE_TEST_SUITE_P(Withy, AdaptiveIntegratorSuite,
                         testing::Values(AdaptiveIntegratorCase{"rk4_adaptive", controlled("rk4-adaptive"), 10},
                                         AdaptiveIntegratorCase{"dopri5", controlled("dopri5"), 10},
                                         AdaptiveIntegratorCase{"dop853", controlled("dop853"), 10}),
                         adaptive_case_name);

}  // namespace
}  // namespace withy
