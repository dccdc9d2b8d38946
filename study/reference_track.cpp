#include "withy/study/reference_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "withy/core/simulation/instants.hpp"

namespace withy::study {
namespace {

constexpr std::size_t most_windows = 24;
/// Readings of a whole run: each costs about an evaluation.
constexpr double readings = 400;
/// The loosest tolerance of coarse runs, which are made to the accuracy asked: both make nearly the same errors of
/// steps, so that their difference is right to about the tolerance of itself.
constexpr double loosest = 1e-2;

/// An integrator that coarse runs may take.
struct Contender {
  const char* id;
  double weight;  ///< of an evaluation with its share of the step, over one of dopri5
};
/// Measured: imex 1.3, radau 2.2. imex counts for less, since its steps grow as vibrations that the start has raised
/// decay or no longer matter, which the beginning of a run does not show.
constexpr std::array<Contender, 4> contenders = {{{"imex", 0.9}, {"radau", 2.2}, {"dopri5", 1}, {"dop853", 1}}};

/// Third-order terms beyond this part of the accuracy are looked at: (deflection over length)² of the range (spin-up:
/// 0.36 % at 0.057, 0.49 % at 0.067).
constexpr double worth_a_look = 0.02;

/// Ends of windows [s]: outputs of the run, so that a change of rungs is one.
std::vector<double> window_ends(double start, double end, double output) {
  std::vector<double> ends;
  const double outputs = (end - start) / output;
  const auto windows = static_cast<double>(std::clamp<std::size_t>(static_cast<std::size_t>(outputs), 1, most_windows));
  for (double k = 1; k < windows; ++k) {
    const double t = std::round((start + (end - start) * k / windows) / output) * output;
    if (t > (ends.empty() ? start : ends.back()) && t < end - 1e-6 * output) ends.push_back(t);
  }
  ends.push_back(end);
  return ends;
}

/// A number of evaluations for a cost; all that a run may need where there is no limit.
std::size_t evaluations_within(double cost) {
  constexpr double most = 1e15;
  return static_cast<std::size_t>(std::min(cost, most));
}

/// The integrator that costs least in the least rung over the second window; the first one has its first steps.
std::string cheapest_integrator(const Prepared& prepared, Registry& registry, const Outputs& outputs, double tolerance,
                                const State& start, const std::vector<double>& ends,
                                std::vector<std::size_t>& evaluations) {
  std::string best = "dopri5";
  double least = std::numeric_limits<double>::infinity();
  const EquationsOfMotion& equations = *prepared.rungs.front().equations;
  const double until = ends[std::min<std::size_t>(1, ends.size() - 1)];
  for (const Contender& c : contenders) {
    if (std::string(c.id) == "imex" && equations.linearly_implicit() == nullptr) continue;
    const auto integrator = make_integrator(registry, c.id, tolerance);
    CoarseRun run(prepared, equations, outputs, *integrator, start, until);
    const auto affordable = [&](double factor) { return evaluations_within(factor * least / c.weight); };
    bool reached = run.to(ends.front(), {}, affordable(3));
    const std::size_t before = ends.size() > 1 ? run.evaluations() : 0;
    reached = reached && run.to(until, {}, before + affordable(1));
    evaluations.front() += run.evaluations();
    const double cost = c.weight * static_cast<double>(run.evaluations() - before);
    if (!reached || cost >= least) continue;
    least = cost;
    best = c.id;
  }
  return best;
}

/// What is to be known of readings as they come.
class Extremes {
 public:
  Extremes(const Outputs& outputs, ReferenceTrack& track, std::vector<double> first)
      : outputs_(outputs), track_(track), first_(std::move(first)) {
    raise(first_);
  }
  void raise(const std::vector<double>& values) {
    outputs_.raise(values, first_, track_.ranges);
    for (const Output& o : outputs_.list()) {
      if (o.measure != Measure::deflection || !(o.floor > 0)) continue;
      constexpr double floor_of_length = 1e-3;
      const double d = std::hypot(values[o.at], values[o.at + 1], values[o.at + 2]);
      track_.deflection = std::max(track_.deflection, floor_of_length * d / o.floor);
    }
  }

 private:
  const Outputs& outputs_;
  ReferenceTrack& track_;
  std::vector<double> first_;
};

/// Runs it in its rung. False where deflections pass a limit.
bool track_in(const Prepared& prepared, Registry& registry, const Outputs& outputs, ReferenceTrack& track,
              double most_deflection, const Control& control, std::vector<std::size_t>& evaluations) {
  const auto integrator = make_integrator(registry, track.integrator, track.tolerance);
  CoarseRun run(prepared, *prepared.rungs[track.rung].equations, outputs, *integrator, track.start, track.end);
  track.windows.clear();
  track.ranges = outputs.none();
  Extremes extremes(outputs, track, run.read());
  for (const double end : window_ends(track.start.time, track.end, prepared.scene.output)) {
    WindowTrack window;
    const bool reached = run.track(end, control, (track.end - track.start.time) / readings, window);
    for (const std::vector<double>& values : window.readings)
      if (!values.empty()) extremes.raise(values);
    track.energy = std::max(track.energy, run.kinetic_energy());
    if (!reached) {
      track.problem = control.stop() ? "interrupted" : "it cannot go on";
      break;
    }
    track.windows.push_back(std::move(window));
    if (track.deflection > most_deflection) break;
  }
  evaluations[track.rung] += run.evaluations();
  return !(track.deflection > most_deflection);
}

}  // namespace

ReferenceTrack track_reference(const Prepared& prepared, Registry& registry, const Outputs& outputs, double accuracy,
                               const Control& control, std::vector<std::size_t>& evaluations) {
  ReferenceTrack track;
  track.tolerance = std::clamp(accuracy, 1e-7, loosest);
  track.start = begun(prepared.model(), *prepared.rungs.front().equations, prepared.scene.initial);
  track.end = end_of_run(prepared.scene);
  track.integrator = cheapest_integrator(prepared, registry, outputs, track.tolerance, track.start,
                                         window_ends(track.start.time, track.end, prepared.scene.output), evaluations);
  const auto& rungs = prepared.rungs;
  const bool exact = rungs.back().terms.strain == StrainOrder::exact;
  track.rung = rungs.size() - (exact ? 2 : 1);
  const double small = exact ? std::sqrt(worth_a_look * accuracy) : std::numeric_limits<double>::infinity();
  if (track_in(prepared, registry, outputs, track, small, control, evaluations)) {
    track.third_order = track.deflection * track.deflection;
    return track;
  }
  track.rung = rungs.size() - 1;
  track.problem.clear();
  track_in(prepared, registry, outputs, track, std::numeric_limits<double>::infinity(), control, evaluations);
  return track;
}

}  // namespace withy::study
