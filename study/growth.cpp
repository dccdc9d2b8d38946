#include "withy/study/growth.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy::study {
namespace {

/// What the bodies' indicators explain.
std::string physical_cause(const RunSummary& summary) {
  std::string text;
  for (const BodyValidity& b : summary.validity.bodies) {
    if (b.rate_ratio >= 1)
      text += fmt::format(
          " '{}' turns at {:.3g} times its fundamental frequency of {:.4g} rad/s (at t = {:.4g} s): where a "
          "formulation "
          "knows rotation's inertia and not the stiffening it causes, its stiffness is negative from there on.",
          b.name, b.rate_ratio, b.fundamental, b.rate_time);
    if (b.buckling >= 1)
      text += fmt::format(" '{}' is compressed by {:.3g} times its buckling load (at t = {:.4g} s).", b.name,
                          b.buckling, b.load_time);
  }
  return text;
}

}  // namespace

std::string growth_text(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const bool may_grow = summary.status == RunStatus::diverged || summary.status == RunStatus::step_underflow ||
                        summary.status == RunStatus::inaccurate;
  if (!may_grow || model.layout().speeds > largest_examined) return {};
  try {
    const TangentDynamics dynamics(prepared.scene.model, prepared.scene.formulation->terms());
    const FastestPole pole = growing_pole(dynamics, summary.final, driven_speeds(model));
    const double lasted = summary.reached - prepared.scene.initial.time;
    if (!(pole.value.real() * lasted > 1)) return physical_cause(summary);
    return fmt::format(
        " About the state at t = {:.4g} s small motions grow by {:.3g}/s{}, most by {} on {}.{}", summary.final.time,
        pole.value.real(), pole.value.imag() > 0 ? fmt::format(", vibrating at {:.3g} rad/s", pole.value.imag()) : "",
        pole.cause.empty() ? "forces" : pole.cause, model.layout().speed_names[pole.speed], physical_cause(summary));
  } catch (const std::domain_error&) {
    return physical_cause(summary);  // there are no derivatives at that state
  }
}

}  // namespace withy::study
