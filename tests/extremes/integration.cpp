/// \file
/// Runs at the limits of their integrators: stability, a million periods, jumps of the right-hand side.
#include <cmath>
#include <numbers>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"

namespace withy::extremes {
namespace {

/// A beam at a wall with one mode: an undamped vibration of frequency ω₁ = 1.875² in `ruthless` and, as nothing but its
/// own mode moves, in `consistent`.
const std::string vibration =
    "format: withy/1\ntime: {end: 1}\nbodies: {beam: {type: beam, length: 1, mass_per_length: 1, bending_y: "
    "{stiffness: 1, modes: 1}}}\nhinges: {wall: {type: weld, parent: world, child: beam}}\n"
    "initial: {bodies: {beam: {modes: [0.01]}}}\n";

double energy(const Made& made, const State& s) {
  const Energies e = made.equations->energies(s.y);
  return e.kinetic + e.potential;
}

/// Energy after `steps` steps over that before, with the given integrator; its logarithm.
double energy_growth(const Made& made, const Integrator& method, double h, std::size_t steps) {
  const auto stepper = method.start(*made.equations, made.scene.initial);
  const double before = energy(made, stepper->state());
  const double end = h * static_cast<double>(steps);
  for (std::size_t i = 0; i < steps; ++i)
    if (stepper->step(end).outcome != StepResult::Outcome::ok) return std::numeric_limits<double>::infinity();
  return std::log(energy(made, stepper->state()) / before);
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

void long_run(Campaign& campaign) {
  const double theta = 2 * std::numbers::pi / 100;
  const std::size_t periods = campaign.quick() ? 1000 : 1000000;
  const Made made(vibration, "ruthless");
  const double omega = std::pow(1.8751040687119611664, 2);
  const auto method = integrator(fmt::format("{{name: rk4, step: {:.17g}}}", theta / omega));
  const double log_growth = energy_growth(made, *method, theta / omega, 100 * periods);
  // |R(iθ)|² = 1 − θ⁶/72 + θ⁸/576.
  const double predicted =
      static_cast<double>(100 * periods) * std::log1p(-std::pow(theta, 6) / 72 + std::pow(theta, 8) / 576);
  campaign.row(fmt::format("rk4, {} periods of 100 steps: ln E/E₀", periods), "n ln(1 − θ⁶/72 + θ⁸/576)", "within 1 %",
               fmt::format("{:.6g}; predicted {:.6g}", log_growth, predicted),
               std::abs(log_growth / predicted - 1) < 0.01);
}

void jumps(Campaign& campaign) {
  const FunctionEquations equations = BangBang::equations();
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
        const auto stepper = integrator(fmt::format(fmt::runtime(m.options), h))->start(equations, BangBang::start());
        for (const double limit : {BangBang::first, BangBang::second, BangBang::end}) {
          if (!declared && limit != BangBang::end) continue;
          drive(*stepper, limit);
          if (declared) stepper->restart();
        }
        const double error = BangBang::error(stepper->state().y);
        if (k > 0) order[declared ? 0 : 1] = std::min(order[declared ? 0 : 1], std::log2(before / error));
        before = error;
      }
    }
    campaign.row(fmt::format("{}, bang-bang, least order over five halvings", m.name), "closed form",
                 fmt::format("≥ {:g} − 0.1 with declared switches", m.order),
                 fmt::format("{:.2f}; undeclared {:.2f}", order[0], order[1]), order[0] >= m.order - 0.1);
  }
  // Error control: the achieved error falls with the work as the order says, the switches declared.
  for (const auto& [name, order] : {std::pair("dopri5", 5.0), {"dop853", 8.0}, {"rk4-adaptive", 4.0}}) {
    double slope = 10;
    double error_before = 0, work_before = 0;
    const double tolerances[] = {1e-6, 1e-8, 1e-10};
    std::string text;
    for (const double tolerance : tolerances) {
      const auto stepper = integrator(fmt::format("{{name: {}, rtol: {}, atol: {}}}", name, tolerance, tolerance))
                               ->start(equations, BangBang::start());
      for (const double limit : {BangBang::first, BangBang::second, BangBang::end}) {
        drive(*stepper, limit);
        stepper->restart();
      }
      const double error = BangBang::error(stepper->state().y);
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
