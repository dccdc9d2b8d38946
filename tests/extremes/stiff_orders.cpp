/// \file
/// The order that is left where equations are stiff, for each integrator: Prothero and Robinson's problem, the pair of
/// Kværnø, Prothero and Robinson, and a stiff oscillator for methods of second-order equations.
#include <algorithm>
#include <cmath>

#include "campaign.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/integrators/stiff_problems.hpp"

namespace withy::extremes {
namespace {

struct Orders {
  const char* id;
  double published[3];  ///< docs/integrators.md: at λ = −1, −1e3, −1e6; 0: a step is limited by stability there
  double prothero_step[3], kpr_step[3];
};

// The steps: the first within the asymptotic range, those after it where h |λ| is large and errors are above rounding.
const Orders first_order[] = {
    {"rk4", {4, 0, 0}, {0.25, 0, 0}, {0.015625, 0, 0}},
    {"rk4-adaptive", {5, 0, 0}, {0.25, 0, 0}, {0.015625, 0, 0}},
    {"dopri5", {5, 0, 0}, {0.25, 0, 0}, {0.015625, 0, 0}},
    {"dop853", {8, 0, 0}, {0.5, 0, 0}, {0.0625, 0, 0}},
    {"radau", {5, 3, 3}, {0.5, 0.5, 0.5}, {0.125, 0.0625, 0.03125}},
    {"gauss", {6, 4, 4}, {0.5, 0.125, 0.125}, {0.125, 0.0625, 0.03125}},
    {"imex", {5, 2, 2}, {0.25, 0.125, 0.0625}, {0.0625, 0.0625, 0.03125}},
    {"rosenbrock-w", {3, 2, 2}, {0.125, 0.125, 0.125}, {0.03125, 0.03125, 0.0078125}},
};

/// log₂ of the ratio of the errors with steps h and h/2: at the end, or the greatest after any step.
template <class Error>
double order_of(const std::string& id, double h, const EquationsOfMotion& equations, const State& start, double end,
                Error&& error, bool greatest = false) {
  double errors[2] = {};
  for (int i = 0; i < 2; ++i) {
    std::string options = equal_steps(id, h / (1 << i));
    if (id == "generalized-alpha") options.insert(options.size() - 1, ", rho_infinity: 0.5");
    const auto stepper = integrator(options)->start(equations, start);
    while (stepper->state().time < end) {
      if (stepper->step(end).outcome != StepResult::Outcome::ok) return std::nan("");
      const double e = error(stepper->state().time, stepper->state().y);
      errors[i] = greatest ? std::max(errors[i], e) : e;
    }
  }
  return std::log2(errors[0] / errors[1]);
}

}  // namespace

void stiff_orders(Campaign& campaign) {
  const double lambdas[] = {-1, -1e3, -1e6};
  const auto sine = [](double t, std::span<const double> y) { return std::abs(y[0] - std::sin(t)); };
  for (const char* problem : {"Prothero–Robinson", "KPR"}) {
    const bool kpr = problem == std::string("KPR");
    for (const Orders& o : first_order) {
      std::string published, measured;
      bool met = true;
      // What the explicit methods leave at the end crosses zero with h; it is the greatest that shows their order.
      const bool implicit = o.published[1] > 0;
      for (int k = 0; k < 3; ++k) {
        if (o.published[k] == 0) continue;
        const double order =
            kpr ? order_of(o.id, o.kpr_step[k], Kpr::equations(lambdas[k]), Kpr::start(), 2, Kpr::error, !implicit)
                : order_of(o.id, o.prothero_step[k], prothero_robinson(lambdas[k]), {0, {0, 0, 0}}, 2, sine);
        published += fmt::format("{}{:g}", k > 0 ? ", " : "", o.published[k]);
        measured += fmt::format("{}{:.2f}", k > 0 ? ", " : "", order);
        met = met && std::abs(order - o.published[k]) <= 0.25;
      }
      campaign.row(
          fmt::format("{}, {}, λ = −1{}", o.id, problem, implicit ? ", −10³, −10⁶" : " (beyond, h |λ| is limited)"),
          "closed form", "published " + published + " ± 0.25", measured, met);
    }
  }
  std::string measured;
  bool met = true;
  double h = 0.0625;
  for (const double k : {1.0, 1e3, 1e6}) {
    const double order = order_of("generalized-alpha", h, stiff_oscillator(k), {0, {0, 1, 0}}, 20, sine);
    measured += fmt::format("{}{:.2f}", k > 1 ? ", " : "", order);
    met = met && std::abs(order - 2) <= 0.25;
    h = k == 1 ? 0.25 : 0.5;
  }
  campaign.row("generalized-alpha, oscillator of stiffness 1, 10³, 10⁶", "closed form", "published 2, 2, 2 ± 0.25",
               measured, met);
}

}  // namespace withy::extremes
