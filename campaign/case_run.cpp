#include "withy/campaign/case_run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "withy/campaign/kept.hpp"
#include "withy/core/simulation/run_times.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"

namespace withy::campaign {
namespace {

RunSummary simulate_case(const study::Prepared& prepared, KeptNumbers& kept, Registry& registry,
                         const study::Control& control) {
  const Scene& scene = prepared.scene;
  if (prepared.escalates()) {
    study::RunSettings settings;
    settings.look_beyond = false;
    settings.output = [&](const State& state, std::size_t rung) { kept.see(state, rung); };
    settings.control.interrupted = control.interrupted;  // progress is that of many cases
    return study::run(prepared, registry, settings).summary;
  }
  RunOptions options = study::run_options(scene);
  options.interrupted = control.interrupted;
  if (kept.watches_steps()) {
    // A checkpoint after every step has its state, and changes nothing in a run.
    options.checkpoint_due = [] { return true; };
    options.checkpoint = [&](const Checkpoint& checkpoint) { kept.see(checkpoint.state, 0); };
  }
  return withy::simulate(*scene.model, *prepared.equations, *scene.integrator, scene.initial, options,
                         [&](const State& state) { kept.see(state, 0); });
}

/// Numbers that are none end a case as what they are.
void check_finite(CaseResult& result) {
  for (const double x : result.numbers) {
    if (std::isfinite(x)) continue;
    result.status = name(RunStatus::diverged);
    result.message = "a kept result is not finite";
    result.numbers.clear();
    return;
  }
}

}  // namespace

CaseResult run_case(const Plan& plan, const Cases& cases, std::uint64_t index, Registry& registry,
                    const study::Control& control) {
  const double began = thread_cpu_seconds();
  CaseResult result;
  result.index = index;
  result.values = cases.values(index);
  try {
    const study::Prepared prepared =
        study::prepare(cases.scene(result.values, fmt::format("case {}", index)), registry);
    KeptNumbers kept(plan, prepared);
    const RunSummary summary = simulate_case(prepared, kept, registry, control);
    result.status = name(summary.status);
    if (result.completed()) {
      result.numbers = kept.numbers(summary);
      check_finite(result);
    } else {
      result.message = summary.message;
    }
  } catch (const SceneError& e) {
    result.status = "refused";
    result.message = e.what();
  } catch (const study::InputError& e) {
    result.status = "refused";
    result.message = e.what();
  } catch (const std::invalid_argument& e) {
    result.status = "refused";
    result.message = e.what();
  }
  result.seconds = thread_cpu_seconds() - began;
  return result;
}

}  // namespace withy::campaign
