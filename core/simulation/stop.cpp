#include "withy/core/simulation/stop.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/given_steps.hpp"

namespace withy {
namespace {

std::string text_of(const NonfiniteMotion& motion) {
  return "motion '" + motion.name + "' has no finite " + motion.quantity + " at t = " + brief(motion.time) + " s";
}

}  // namespace

std::optional<NonfiniteMotion> nonfinite_motion(const Model& model, double time, double ahead) {
  for (const MotionNode& node : model.motions()) {
    for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
      const MotionPoint p = node.motion->at(time + after);
      const bool placed = std::isfinite(p.position), moving = std::isfinite(p.rate);
      if (!(placed && moving && std::isfinite(p.acceleration)))
        return NonfiniteMotion{node.name, !placed ? "coordinate" : moving ? "acceleration" : "rate", time + after};
      if (!(ahead > 0)) break;
    }
  }
  return {};
}

Stop stop_of(const SteppingEnd& end, const Model& model, const EquationsOfMotion& equations, const State& state,
             const Stepper& stepper) {
  if (end.cause == SteppingEnd::Cause::crowded)
    return {RunStatus::step_underflow, "switches or events follow each other without time between them"};
  if (end.cause == SteppingEnd::Cause::unknown_inside)
    return {RunStatus::diverged,
            "the integrator's states within its last step are not finite, where those at its ends are", false};
  if (end.cause != SteppingEnd::Cause::failed) return {};
  if (!end.reason.empty()) return {RunStatus::load_failed, end.reason, false};
  const StepResult& result = end.step;
  const double ahead = stepper.statistics().largest_step;
  if (result.outcome == StepResult::Outcome::nonfinite || result.outcome == StepResult::Outcome::step_underflow)
    if (const auto motion = nonfinite_motion(model, state.time, ahead))
      return {RunStatus::diverged, text_of(*motion), false};
  const bool known = result.body >= 0 && static_cast<std::size_t>(result.body) < model.bodies().size();
  const std::string body = known ? " at body '" + model.bodies()[static_cast<std::size_t>(result.body)].name + "'" : "";
  const std::string where =
      body + (tried_as_given(stepper) ? ", in steps as long as given" : ", however small the step");
  switch (result.outcome) {
    case StepResult::Outcome::nonfinite: {
      const std::string culprit = describe_nonfinite(model, equations, state, ahead);
      return {RunStatus::diverged,
              "the derivatives are not finite" + where + (culprit.empty() ? culprit : ": " + culprit)};
    }
    case StepResult::Outcome::singular:
      // No mass matrix can be solved whose hinge is no number.
      if (const auto hinge = nonfinite_hinge(model, state, ahead))
        return {RunStatus::diverged, "the derivatives are not finite" + where + ": " + hinge->why};
      if (dynamic_cast<const ClosedLoops*>(&equations) != nullptr && result.body < 0)
        return {RunStatus::singular,
                "the loops cannot be closed at the end of a step, however small: they reach a configuration from which "
                "they do not move on, or motions that leave them no way",
                false};
      return {RunStatus::singular, "the mass matrix cannot be solved" + where};
    case StepResult::Outcome::step_underflow:
      return {RunStatus::step_underflow,
              "the accuracy asked for needs steps below the resolution of time, or below the integrator's 'min_step'"};
    case StepResult::Outcome::ok:
      break;
  }
  return {};
}

bool tried_as_given(const Stepper& stepper) {
  return dynamic_cast<const GivenSteps*>(&stepper) != nullptr && stepper.statistics().rejected <= 1;
}

std::string steps_too_long(const RunSummary& summary, const Integrator& integrator, double mean_step) {
  // Of the greatest stable step: a mean beyond this is no going to and fro about the limit.
  constexpr double beyond = 1.5;
  const double product = mean_step * summary.fastest_mode;
  const std::optional<double> limit = integrator.stability_limit();
  if (!limit || !std::isfinite(*limit) || !(product > beyond * *limit)) return {};
  return "Steps of " + brief(mean_step) + " s are too long for the integrator: times the fastest mode, " +
         brief(summary.fastest_mode) + " rad/s, they are " + brief(product) + ", and it is stable to " + brief(*limit) +
         ". ";
}

namespace {

/// Drift of energy that no stable integration leaves, of a formulation that need not conserve it.
constexpr double unstable_drift = 0.05;

}  // namespace

bool surely_balanced(const RunSummary& summary, const RunOptions& options) {
  return summary.energy_drift <= std::min(unstable_drift, options.drift_limit);
}

std::string imbalance(const RunSummary& summary, const RunOptions& options, const Integrator& integrator,
                      double mean_step) {
  std::string text = steps_too_long(summary, integrator, mean_step);
  if (text.empty() && options.too_fast && summary.energy_drift > unstable_drift) {
    text = options.too_fast(summary, mean_step);
    if (!text.empty()) text += ' ';
  }
  const double allowed = !text.empty() ? std::min(unstable_drift, options.drift_limit) : options.drift_limit;
  if (!(summary.energy_drift > allowed)) return {};
  text += "Energy and work do not balance: off by " + brief(summary.energy_drift) + " of the greatest energy";
  if (std::isfinite(options.drift_limit))
    text += ", where the formulation conserves energy and the tolerance explains at most " + brief(options.drift_limit);
  return text + ".";
}

std::string explain(Stop& stop, double time, const MassMatrixHistory* history, const Layout& layout) {
  if (stop.status == RunStatus::step_underflow && history != nullptr && history->lost_definiteness())
    stop.status = RunStatus::singular;
  std::string text = "t = " + brief(time) + " s: " + stop.reason + ".";
  if (!stop.physical) return text;
  if (history == nullptr) return text + " The mass matrix, with so many rows, was not examined.";
  const bool sound = stop.status != RunStatus::singular && !history->lost_definiteness() &&
                     history->end.smallest_eigenvalue > 0 && !history->end.weakest.empty();
  return text + " " + (sound ? describe_sound(*history) : describe(*history, layout));
}

std::string_view name(RunStatus status) {
  switch (status) {
    case RunStatus::completed:
      return "completed";
    case RunStatus::inaccurate:
      return "inaccurate";
    case RunStatus::diverged:
      return "diverged";
    case RunStatus::singular:
      return "singular";
    case RunStatus::step_underflow:
      return "step-underflow";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::load_failed:
      return "load-failed";
    case RunStatus::too_stiff:
      return "too-stiff";
  }
  return "unknown";
}

}  // namespace withy
