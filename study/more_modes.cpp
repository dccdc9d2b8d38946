#include "withy/study/more_modes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/simulation/step_watch.hpp"
#include "withy/study/growth.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/point.hpp"
#include "withy/study/sampled_growth.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {
namespace {

/// Of a run, to be compared.
constexpr double times_compared = 500;

/// What a scene writes to its results is its own affair: rare outputs would miss most of what the runs differ by.
double interval(const Prepared& model, double until) { return (until - model.scene.initial.time) / times_compared; }

/// Outputs of the run that there was, up to a time.
struct ReadRun {
  Readings readings;
  Walk walk;
};

ReadRun read_again(const Prepared& model, const Outputs& outputs, double until,
                   const std::function<bool()>& interrupted) {
  ReadRun run;
  OutputReader reader(outputs, model.model(), *model.equations);
  const auto keep = [&](const State& state) {
    if (state.time > until) return false;
    run.readings.times.push_back(state.time);
    run.readings.values.push_back(reader.read(state));
    return true;
  };
  run.walk = walk(model, *model.scene.integrator, {keep, {}, interrupted, interval(model, until)});
  return run;
}

/// Outputs of a run that nobody has seen: it has the limits of any run.
RunSummary run_richer(const Prepared& rich, const Outputs& outputs, double until,
                      const std::function<bool()>& interrupted, Readings& readings) {
  OutputReader reader(outputs, rich.model(), *rich.equations);
  RunOptions options = run_options(rich.scene);
  options.end = until;
  options.output = interval(rich, until);
  options.past_stops = true;
  options.interrupted = interrupted;
  const auto keep = [&](const State& state) {
    readings.times.push_back(state.time);
    readings.values.push_back(reader.read(state));
  };
  return withy::simulate(rich.model(), *rich.equations, *rich.scene.integrator, rich.scene.initial, options, keep,
                         nullptr, Attention::outcome);
}

/// How that run ended, and what grows there.
std::string bad_end(const Prepared& rich, const RunSummary& summary) {
  const std::string sampled = sampled_growth_text(rich, summary);
  // Of a deflection past its limit the message begins with the time.
  const std::string time =
      summary.message.starts_with("t = ") ? std::string() : fmt::format(" at {:.4g} s", summary.reached);
  return fmt::format("the run with one mode more of each ended as {}{}: {}{}", name(summary.status), time,
                     summary.message, sampled.empty() ? growth_text(rich, summary) : sampled);
}

/// The scene with one mode more of each; nothing where a body cannot have it.
std::optional<Prepared> richer(const Prepared& prepared, Registry& registry, std::string& why_not) {
  try {
    return prepare(with_more_modes(prepared.values, prepared.scene, 1, registry), registry);
  } catch (const SceneError& e) {
    why_not = e.what();
  } catch (const InputError& e) {
    why_not = e.what();
  }
  return {};
}

}  // namespace

bool can_be_refined(const Scene& scene) {
  return std::any_of(scene.modes.begin(), scene.modes.end(), [](const BodyModes& body) {
    return std::any_of(body.counts.begin(), body.counts.end(), [](const ModeCount& c) { return c.modes > 0; });
  });
}

MoreModesOutcome with_one_mode_more(const Prepared& prepared, Registry& registry, double until,
                                    const std::function<bool()>& interrupted) {
  if (!can_be_refined(prepared.scene)) return {};
  std::string why_not;
  const std::optional<Prepared> rich = richer(prepared, registry, why_not);
  if (!rich) return {{}, std::move(why_not)};
  const Outputs outputs = Outputs::all(prepared.model());
  const ReadRun ours = read_again(prepared, outputs, until, interrupted);
  Readings theirs;
  const RunSummary summary = run_richer(*rich, outputs, until, interrupted, theirs);
  if (ours.walk.end == Walk::End::interrupted || summary.status == RunStatus::interrupted) return {{}, "interrupted"};
  if (summary.status != RunStatus::completed) return {{}, bad_end(*rich, summary)};
  const auto [apart, last] = distances(outputs, ours.readings, theirs);
  return {MoreModes{named(outputs, apart, last), until, ours.walk.evaluations + summary.steps.evaluations,
                    ours.walk.seconds + summary.cpu_seconds},
          {}};
}

}  // namespace withy::study
