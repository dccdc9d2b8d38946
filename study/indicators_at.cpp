#include "withy/study/indicators_at.hpp"

#include <stdexcept>

namespace withy::study {

std::vector<Indicator> indicators_at(const Prepared& prepared, const State& state) {
  RunOptions options;
  options.end = state.time;
  options.deflection_limit = prepared.scene.deflection_limit;
  try {
    const RunSummary summary = withy::simulate(prepared.model(), *prepared.equations, *prepared.scene.integrator, state,
                                               options, [](const State&) {});
    if (summary.status != RunStatus::completed) return {};
    std::vector<Indicator> all = indicators(prepared.scene, summary);
    add_rounding(all, prepared.model(), *prepared.equations, state);
    return all;
  } catch (const std::invalid_argument&) {  // an integrator that cannot treat these equations
    return {};
  }
}

}  // namespace withy::study
