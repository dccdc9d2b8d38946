#include "withy/study/growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/felt_motion.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"

namespace withy::study {
namespace {

/// What the motion of the bodies explains at the last trusted state: behind it a body may turn as fast as it likes.
std::string physical_cause(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const EquationsOfMotion& equations = *prepared.equations;
  const State& state = summary.final;
  std::vector<double> rates(equations.size());
  Work work = equations.make_work();
  if (!equations.derivatives(state.time, state.y, rates, work).ok()) return {};
  TreeMotion motion(model);
  motion.update(state.y, std::span<const double>(rates).subspan(model.layout().positions, model.layout().speeds));
  const std::vector<BodyMotion> felt = felt_motions(model, equations, state, motion.bodies());
  std::string text;
  for (const BodyValidity& b : summary.validity.bodies) {
    const auto index = static_cast<std::size_t>(model.body(b.name));
    const double rate = b.fundamental > 0 ? motion.bodies()[index].rate.norm() / b.fundamental : 0;
    const double buckling = -MotionStiffness(model, index).evaluate(felt).least;
    if (rate >= 1)
      text += fmt::format(
          " There '{}' turns at {:.3g} times its fundamental frequency of {:.4g} rad/s: where a formulation knows the "
          "inertia of rotation and not the stiffening it causes, its stiffness is negative from there on.",
          b.name, rate, b.fundamental);
    if (buckling >= 1)
      text += fmt::format(" There '{}' is compressed by {:.3g} times its buckling load.", b.name, buckling);
  }
  return text;
}

}  // namespace

std::string growth_text(const Prepared& prepared, const RunSummary& summary) {
  const Model& model = prepared.model();
  const bool may_grow = summary.status == RunStatus::diverged || summary.status == RunStatus::step_underflow ||
                        summary.status == RunStatus::inaccurate;
  if (!may_grow || model.layout().speeds > largest_examined) return {};
  if (!loops_of(model).empty()) return physical_cause(prepared, summary);  // tangents are a tree's
  try {
    const TangentDynamics dynamics(prepared.scene.model, prepared.scene.formulation->terms());
    const FastestPole pole = growing_pole(dynamics, summary.final, driven_speeds(model, summary.final));
    const double lasted = summary.reached - prepared.scene.initial.time;
    if (!(pole.value.real() * lasted > 1)) return physical_cause(prepared, summary);
    return fmt::format(" About the state at t = {:.4g} s small motions grow by {:.3g}/s{}, most by {} on {}.{}",
                       summary.final.time, pole.value.real(),
                       pole.value.imag() > 0 ? fmt::format(", vibrating at {:.3g} rad/s", pole.value.imag()) : "",
                       pole.cause.empty() ? "forces" : pole.cause, model.layout().speed_names[pole.speed],
                       physical_cause(prepared, summary));
  } catch (const std::domain_error&) {
    return physical_cause(prepared, summary);  // there are no derivatives at that state
  }
}

}  // namespace withy::study
