#include "withy/core/simulation/integrator_call.hpp"

#include <stdexcept>

#include "withy/core/plugin/plugin_call.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy {
namespace {

/// A limit is asked for only where a run has ended badly, and would fail there.
void check_stability(const Integrator& integrator, const std::string& who) {
  const std::optional<double> limit =
      plugin_call(who + " does not say how long its steps may be", [&] { return integrator.stability_limit(); });
  if (!limit || *limit > 0) return;
  throw std::invalid_argument(who + " says that it is stable to h ω = " + brief(*limit) +
                              "; need a positive number, infinity, or nothing where it is not known");
}

}  // namespace

std::unique_ptr<Stepper> start_stepper(const Integrator& integrator, const EquationsOfMotion& equations,
                                       const State& state, const std::string& who) {
  check_stability(integrator, who);
  std::unique_ptr<Stepper> stepper =
      plugin_call(who + " cannot begin", [&] { return integrator.start(equations, state); });
  if (stepper == nullptr) throw std::invalid_argument(who + " cannot begin and does not say why");
  const State& begun = stepper->state();
  if (begun.y.size() != state.y.size() || begun.time != state.time)
    throw std::invalid_argument(
        who + " begins at another state: t = " + brief(begun.time) + " s and " + std::to_string(begun.y.size()) +
        " numbers, where it was given t = " + brief(state.time) + " s and " + std::to_string(state.y.size()));
  return stepper;
}

void interpolate_step(const Stepper& stepper, double t, std::span<double> y) {
  plugin_call<IntegratorError>("does not interpolate within its steps", [&] { stepper.interpolate(t, y); });
}

std::vector<std::string> remarks_of(const Stepper& stepper) {
  return plugin_call<IntegratorError>("does not say how it has integrated", [&] { return stepper.remarks(); });
}

}  // namespace withy
