#include "withy/study/more_modes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/study/input_error.hpp"
#include "withy/study/output_reader.hpp"
#include "withy/study/point.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {
namespace {

/// Of a run, to be compared.
constexpr double times_compared = 500;

/// A run's outputs up to a time; `walk` says how it ended.
struct ReadRun {
  Readings readings;
  Walk walk;
};

ReadRun read_run(const Prepared& model, const Outputs& outputs, double until,
                 const std::function<bool()>& interrupted) {
  ReadRun run;
  OutputReader reader(outputs, model.model(), *model.equations);
  const auto keep = [&](const State& state) {
    if (state.time > until) return false;
    run.readings.times.push_back(state.time);
    run.readings.values.push_back(reader.read(state));
    return true;
  };
  // What a scene writes to its results is its own affair: rare outputs would miss most of what the runs differ by.
  const double interval = (until - model.scene.initial.time) / times_compared;
  run.walk = walk(model, *model.scene.integrator, {keep, {}, interrupted, interval});
  return run;
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
  const ReadRun ours = read_run(prepared, outputs, until, interrupted);
  const ReadRun theirs = read_run(*rich, outputs, until, interrupted);
  if (ours.walk.end == Walk::End::interrupted || theirs.walk.end == Walk::End::interrupted) return {{}, "interrupted"};
  const auto [apart, last] = distances(outputs, ours.readings, theirs.readings);
  if (theirs.walk.end == Walk::End::stopped)
    return {{}, fmt::format("that run ends at {:.4g} s: {}", theirs.walk.time, theirs.walk.reason)};
  return {MoreModes{named(outputs, apart, last), until, ours.walk.evaluations + theirs.walk.evaluations,
                    ours.walk.seconds + theirs.walk.seconds},
          {}};
}

}  // namespace withy::study
