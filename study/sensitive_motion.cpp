#include "withy/study/sensitive_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/simulation/paired_run.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/coarse_run.hpp"

namespace withy::study {
namespace {

/// How far a run of a rung at some tolerances is from the run; nothing where it does not come to the end.
std::optional<double> apart_from(const std::vector<std::vector<double>>& own, const Prepared& prepared,
                                 std::size_t rung, const Integrator& integrator, std::size_t most, RungPlan& plan,
                                 const Control& control) {
  const Outputs outputs(prepared.model());
  Distances apart = outputs.none();
  CoarseRun run(prepared, rung, rung, outputs, integrator,
                begun(prepared.model(), *prepared.rungs[rung].equations, prepared.scene.initial),
                end_of_run(prepared.scene));
  bool on = true;
  for (std::size_t i = 0; on && i < plan.readings.size(); ++i) {
    on = run.to(plan.readings[i].time, control, most);
    if (on && i < own.size() && !own[i].empty()) outputs.raise(run.read(), own[i], apart);
  }
  run.charge(plan.evaluations);
  if (!on) return {};
  return relative_error(apart, plan.scales);
}

}  // namespace

std::string sensitive_text(double apart, double rtol) {
  return fmt::format(
      "not known: the motion is sensitive. A run of the same equations at rtol {:.0e} ends {:.2g} % of an output's "
      "range away from this run, and two formulations part as far as any two runs do",
      rtol, 100 * apart);
}

OtherRuns other_runs(const Prepared& prepared, std::size_t rung, double coarse,
                     const std::vector<std::vector<double>>& own, const RunSummary& summary, RungPlan& plan,
                     Registry& registry, const Control& control) {
  PairedTolerances t = paired_tolerances(summary);
  OtherRuns found{coarse, {}};
  double told = 0;  // rtol of the last that came to the end
  for (std::size_t most : {summary.steps.evaluations, most_closer * summary.steps.evaluations}) {
    // Loads that are stiff for the coarse runs are so here.
    const auto integrator = make_integrator(registry, plan.integrator == "radau" ? "radau" : "dopri5",
                                            Value::map({{"rtol", Value(t.rtol)}, {"atol", Value(t.atol)}}));
    if (const auto apart = apart_from(own, prepared, rung, *integrator, most, plan, control)) {
      found.apart = *apart;
      told = t.rtol;
      if (*apart < another_motion) return found;
    }
    t.rtol *= closer, t.atol *= closer;
  }
  if (told > 0) {
    found.sensitive = fmt::format(
        "The motion is sensitive: a run of the same equations at rtol {:.0e} is {:.2g} % of an output's range away "
        "from "
        "this run, and the error of this one is not known.",
        told, 100 * found.apart);
  } else {
    found.sensitive = fmt::format(
        "The coarse run in {} is {:.2g} % of an output's range off this run, and closer ones {}: whether the motion is "
        "sensitive is not known, and neither is the error.",
        prepared.rungs[rung].name, 100 * coarse,
        control.stop() ? "were interrupted" : "need more evaluations than three such runs");
  }
  return found;
}

}  // namespace withy::study
