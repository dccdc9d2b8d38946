/// \file
/// A million periods of a motion that keeps its energy, and motions run back to where they began.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "campaign.hpp"

namespace withy::extremes {
namespace {

/// Relative differences of the energy to that at the start: the greatest of all blocks of steps, and of the means of
/// the first and the last hundredth of them to each other.
struct Drift {
  double greatest = 0, of_means = 0;
};

Drift drift(const Made& made, const Integrator& method, double h, std::size_t blocks, std::size_t steps) {
  const auto stepper = method.start(*made.equations, made.scene.initial);
  const double before = energy(made, stepper->state());
  const double end = h * static_cast<double>(blocks * steps);
  const std::size_t few = std::max<std::size_t>(1, blocks / 100);
  Drift d;
  double first = 0, last = 0;
  for (std::size_t k = 0; k < blocks; ++k) {
    // The block's mean, so that the phase at its end does not matter.
    double mean = 0;
    for (std::size_t i = 0; i < steps; ++i) {
      if (stepper->step(end).outcome != StepResult::Outcome::ok) return {std::nan(""), std::nan("")};
      mean += energy(made, stepper->state()) / before - 1;
    }
    mean /= static_cast<double>(steps);
    d.greatest = std::max(d.greatest, std::abs(mean));
    if (k < few) first += mean / static_cast<double>(few);
    if (k + few >= blocks) last += mean / static_cast<double>(few);
  }
  d.of_means = std::abs(last - first);
  return d;
}

}  // namespace

void long_run(Campaign& campaign) {
  const double theta = 2 * std::numbers::pi / 100;
  const std::size_t periods = campaign.quick() ? 1000 : 1'000'000;
  const double omega = std::pow(1.8751040687119611664, 2);
  const Made linear(vibration, "ruthless");
  const auto rk4 = integrator(equal_steps("rk4", theta / omega));
  const double log_growth = energy_growth(linear, *rk4, theta / omega, 100 * periods);
  // |R(iθ)|² = 1 − θ⁶/72 + θ⁸/576.
  const double predicted =
      static_cast<double>(100 * periods) * std::log1p(-std::pow(theta, 6) / 72 + std::pow(theta, 8) / 576);
  campaign.row(fmt::format("rk4, {} periods of 100 steps: ln E/E₀", periods), "n ln(1 − θ⁶/72 + θ⁸/576)", "within 1 %",
               fmt::format("{:.6g}; predicted {:.6g}", log_growth, predicted),
               std::abs(log_growth / predicted - 1) < 0.01);
  // Gauss collocation keeps quadratic energies exactly: what is left is rounding, whose sum is compensated. The step is
  // no simple part of the period: else the same roundings come again each period, and what they add up to grows with
  // time, not with its root (measured: 2e-18 a step with 20 steps a period).
  const double steps = 10 * (1 + std::numbers::sqrt2);
  const double h = 2 * std::numbers::pi / steps / omega;
  const std::size_t blocks = static_cast<std::size_t>(steps * static_cast<double>(periods)) / 200;
  const Drift symplectic = drift(linear, *integrator(equal_steps("gauss", h)), h, blocks, 200);
  campaign.at_most(fmt::format("gauss, {} periods of 24.1 steps: |E/E₀ − 1|, symplectic", periods), "quadratic energy",
                   symplectic.greatest, 1e-11);
  // Roundings add up as the root of time: 1e-13 after 1e6 periods.
  const auto compensated = [](std::size_t n) { return 1e-13 * std::sqrt(1e-6 * static_cast<double>(n)); };
  campaign.at_most("the same, as a method whose steps' sums are compensated", "quadratic energy", symplectic.greatest,
                   compensated(periods));
  // Short steps show what the iteration of the stages leaves: with 101 a period it was 2e-19 a step, always of one
  // sign.
  const std::size_t fewer = campaign.quick() ? periods : periods / 10;
  const double short_step = h / 4.2;
  const Drift fine = drift(linear, *integrator(equal_steps("gauss", short_step)), short_step,
                           static_cast<std::size_t>(4.2 * steps * static_cast<double>(fewer)) / 200, 200);
  campaign.at_most(fmt::format("gauss, {} periods of 101.4 steps, compensated", fewer), "quadratic energy",
                   fine.greatest, compensated(fewer));
  // Where the mass depends on the deflection (0.1 L) the method is reversible, no more: the energy moves within a
  // period and must come back.
  const Made nonlinear(vibration, "quadratic", {"initial.bodies.beam.modes=[0.05]"});
  const Drift reversible = drift(nonlinear, *integrator(equal_steps("gauss", h)), h, blocks / 10, 200);
  campaign.at_most(
      fmt::format("gauss, quadratic at 0.1 L, {} periods of 24.1 steps: mean energy, end to start", periods / 10),
      "energy", reversible.of_means, 1e-11);
}

void reversal(Campaign& campaign) {
  const std::size_t steps = campaign.quick() ? 1000 : 10'000;
  const double h = 0.002;
  // Forward, all speeds reversed, as far again, and reversed: the start, but for rounding.
  const auto miss = [&](const Made& made, const std::string& options) {
    const auto reversed = [&](State s) {
      s.time = 0;
      for (std::size_t i = 0; i < made.layout().speeds; ++i) s.y[made.layout().positions + i] *= -1;
      return s;
    };
    State s = made.scene.initial;
    for (int way = 0; way < 2; ++way) {
      const auto stepper = integrator(options)->start(*made.equations, s);
      for (std::size_t i = 0; i < steps; ++i)
        if (stepper->step(h * static_cast<double>(steps)).outcome != StepResult::Outcome::ok) return std::nan("");
      s = reversed(stepper->state());
    }
    s.y.pop_back();  // the work, of which there is none
    State start = made.scene.initial;
    start.y.pop_back();
    return difference(s.y, start.y);
  };
  const double gate = 1e3 * 0x1p-52 * std::sqrt(static_cast<double>(steps));
  for (const std::string formulation : {"ruthless", "quadratic", "exact"}) {
    const Made made(pendulum, formulation);
    const std::string h_text = fmt::format("{:.17g}", h);
    for (const auto& [name, options] :
         {std::pair<std::string, std::string>("gauss", "{name: gauss, step: " + h_text + "}"),
          {"generalized-alpha, ρ∞ = 1", "{name: generalized-alpha, rho_infinity: 1, step: " + h_text + "}"}}) {
      campaign.at_most(fmt::format("{}, {}, {} steps there and back", name, formulation, steps), "the start",
                       miss(made, options), gate);
    }
  }
  // The measure sees a method that is not symmetric.
  const double one_way = miss(Made(pendulum, "quadratic"), fmt::format("{{name: rk4, step: {:.17g}}}", h));
  campaign.row("rk4, not symmetric, the same", "the start", fmt::format("> {:.3g}", gate),
               fmt::format("{:.3g}", one_way), one_way > gate);
}

}  // namespace withy::extremes
