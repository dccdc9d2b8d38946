/// \file
/// Runs at the limits of their integrators: stability, jumps of the right-hand side.
#include <cmath>
#include <numbers>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy::extremes {
namespace {

/// Error of SwitchedOscillator with declared switches, with equal steps of the interval between two switches over
/// `parts`.
double error_over_switches(const std::string& id, int parts) {
  FunctionEquations equations = SwitchedOscillator::equations();
  equations.stiffness_ = {0.5};  // half of it: linearly implicit methods must do with any part
  State state = SwitchedOscillator::start();
  for (const double limit : {SwitchedOscillator::first, SwitchedOscillator::second, SwitchedOscillator::end}) {
    const auto stepper = integrator(equal_steps(id, (limit - state.time) / parts))->start(equations, state);
    drive(*stepper, limit);
    state = stepper->state();
  }
  return SwitchedOscillator::error(state.y);
}

}  // namespace

void stability(Campaign& campaign) {
  struct Method {
    const char* name;
    const char* options;  ///< {0}: the step
    double limit;         ///< where |R(iy)| = 1
    const char* oracle;
  };
  // |R|² − 1 = 0 of the stability polynomials: 1 + z + … + z⁴/24; with z⁵/120 and z⁶/600 for Dormand and Prince.
  const Method methods[] = {{"rk4", "{{name: rk4, step: {0}}}", 2 * std::numbers::sqrt2, "|R(iy)| = 1: 2√2"},
                            {"dopri5", "{{name: dopri5, rtol: 1, atol: 1e300, initial_step: {0}, max_step: {0}}}",
                             0.99752, "|R(iy)| = 1: 0.9975"}};
  const std::size_t steps = campaign.quick() ? 20000 : 200000;
  for (const Method& m : methods) {
    for (const std::string formulation : {"ruthless", "consistent"}) {
      const Made made(vibration, formulation);
      const double omega = std::pow(1.8751040687119611664, 2);
      double low = 0.5 * m.limit, high = 1.5 * m.limit;
      for (int i = 0; i < 14; ++i) {
        const double middle = 0.5 * (low + high);
        const auto method = integrator(fmt::format(fmt::runtime(m.options), middle / omega));
        (energy_growth(made, *method, middle / omega, steps) > 0 ? high : low) = middle;
      }
      campaign.row(fmt::format("{}, {}: greatest stable hω", m.name, formulation), m.oracle, "within 1 %",
                   fmt::format("{:.4f}", high), std::abs(high / m.limit - 1) < 0.01);
    }
  }
}

void jumps(Campaign& campaign) {
  const FunctionEquations equations = SwitchedOscillator::equations();
  struct Method {
    const char* name;
    const char* options;  ///< {0}: step or tolerance
    double order;
    double first, factor;
  };
  // Orders against the step; for error control against the tolerance, where p is that of the mean step.
  const Method methods[] = {{"rk4", "{{name: rk4, step: {0}}}", 4, 0.1, 0.5}};
  for (const Method& m : methods) {
    double order[2] = {10, 10};
    for (const bool declared : {true, false}) {
      double before = 0;
      for (int k = 0; k < 6; ++k) {
        const double h = m.first * std::pow(m.factor, k);
        const auto stepper =
            integrator(fmt::format(fmt::runtime(m.options), h))->start(equations, SwitchedOscillator::start());
        for (const double limit : {SwitchedOscillator::first, SwitchedOscillator::second, SwitchedOscillator::end}) {
          if (!declared && limit != SwitchedOscillator::end) continue;
          drive(*stepper, limit);
          if (declared) stepper->restart();
        }
        const double error = SwitchedOscillator::error(stepper->state().y);
        if (k > 0) order[declared ? 0 : 1] = std::min(order[declared ? 0 : 1], std::log2(before / error));
        before = error;
      }
    }
    campaign.row(fmt::format("{}, bang-bang, least order over five halvings", m.name), "closed form",
                 fmt::format("≥ {:g} − 0.1 with declared switches", m.order),
                 fmt::format("{:.2f}; undeclared {:.2f}", order[0], order[1]), order[0] >= m.order - 0.1);
  }
  // Of every method with equal steps; those of cvode are its own. The error must be above rounding.
  for (const std::string& id : ids<Integrator>()) {
    if (id == "cvode") continue;
    const int p = integrator(equal_steps(id, 0.1))->order();
    const int first = p > 5 ? 1 : 8;
    const double coarse = error_over_switches(id, first);
    double fine = coarse;
    int halvings = 0;
    for (; halvings < 5; ++halvings) {
      const double error = error_over_switches(id, first << (halvings + 1));
      if (error < 1e-13) break;
      fine = error;
    }
    const double order = std::log2(coarse / fine) / halvings;
    campaign.row(fmt::format("{}, bang-bang with declared switches, order over {} halvings", id, halvings),
                 "closed form", fmt::format("≥ {} − 0.1", p), fmt::format("{:.2f}", order),
                 halvings > 0 && order >= p - 0.1);
  }
  // Error control: the achieved error falls with the work as the order says, the switches declared.
  for (const auto& [name, order] : {std::pair("dopri5", 5.0), {"dop853", 8.0}, {"rk4-adaptive", 4.0}}) {
    double slope = 10;
    double error_before = 0, work_before = 0;
    const double tolerances[] = {1e-6, 1e-8, 1e-10};
    std::string text;
    for (const double tolerance : tolerances) {
      const auto stepper = integrator(fmt::format("{{name: {}, rtol: {}, atol: {}}}", name, tolerance, tolerance))
                               ->start(equations, SwitchedOscillator::start());
      for (const double limit : {SwitchedOscillator::first, SwitchedOscillator::second, SwitchedOscillator::end}) {
        drive(*stepper, limit);
        stepper->restart();
      }
      const double error = SwitchedOscillator::error(stepper->state().y);
      const double work = static_cast<double>(stepper->statistics().evaluations);
      if (error_before > 0) slope = std::min(slope, std::log(error_before / error) / std::log(work / work_before));
      error_before = error;
      work_before = work;
      text += fmt::format("{:.1e} ", error / tolerance);
    }
    campaign.row(fmt::format("{}, bang-bang with declared switches, achieved over asked at 1e-6, 1e-8, 1e-10", name),
                 "closed form", "each ≤ 10", text, [&] {
                   double worst = 0;
                   std::istringstream in(text);
                   for (double v; in >> v;) worst = std::max(worst, v);
                   return worst <= 10;
                 }());
  }
}

}  // namespace withy::extremes
