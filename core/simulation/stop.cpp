#include "withy/core/simulation/stop.hpp"

namespace withy {

Stop stop_of(const SteppingEnd& end, const Model& model, const EquationsOfMotion& equations, const State& state,
             const StepStatistics& steps) {
  if (end.cause == SteppingEnd::Cause::crowded)
    return {RunStatus::step_underflow, "switches follow each other without time between them"};
  if (end.cause != SteppingEnd::Cause::failed) return {};
  const StepResult& result = end.step;
  const std::string body =
      result.body >= 0 ? " at body '" + model.bodies()[static_cast<std::size_t>(result.body)].name + "'" : "";
  switch (result.outcome) {
    case StepResult::Outcome::nonfinite: {
      const std::string culprit = describe_nonfinite(model, equations, state, steps.largest_step);
      return {RunStatus::diverged, "the derivatives are not finite, however small the step" + body +
                                       (culprit.empty() ? culprit : ": " + culprit)};
    }
    case StepResult::Outcome::singular:
      return {RunStatus::singular, "the mass matrix cannot be solved, however small the step" + body};
    case StepResult::Outcome::step_underflow:
      return {RunStatus::step_underflow, "the accuracy asked for needs steps below the resolution of time"};
    case StepResult::Outcome::ok:
      break;
  }
  return {};
}

std::string explain(Stop& stop, double time, const MassMatrixHistory* history, const Layout& layout) {
  if (stop.status == RunStatus::step_underflow && history != nullptr && history->lost_definiteness())
    stop.status = RunStatus::singular;
  std::string text = "t = " + brief(time) + " s: " + stop.reason + ".";
  if (!stop.physical) return text;
  return text + (history != nullptr ? " " + describe(*history, layout)
                                    : " The mass matrix, with so many rows, was not examined.");
}

}  // namespace withy
