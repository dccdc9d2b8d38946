#include "withy/study/reference_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "withy/core/simulation/instants.hpp"
#include "withy/study/accuracy.hpp"
#include "withy/study/third_order.hpp"

namespace withy::study {
namespace {

constexpr std::size_t most_windows = 24, least_windows = 6;
/// Every window ends with a landing, which costs a step: where steps are long there are fewer, such that the least rung
/// takes about this many evaluations in one.
constexpr std::size_t worth_a_window = 64;
/// Readings of a whole run: each costs about an evaluation.
constexpr double readings = 400;
/// The loosest tolerance of coarse runs, which are made to the accuracy asked: both make nearly the same errors of
/// steps, so that their difference is right to about the tolerance of itself.
constexpr double loosest = 1e-2;

/// What an evaluation of radau costs with its share of the step, over one of imex: measured, 2.2 over 1.3; less for
/// imex, whose steps grow as vibrations of the start decay or no longer matter, which the beginning of a run does not
/// show.
constexpr double radau_weight = 2.4;
/// The least rung is compared with the reference so many times: each landing costs steps.
constexpr std::size_t comparisons = 8;
/// Third-order terms beyond this part of the accuracy are looked at: (deflection over length)² of the range (spin-up:
/// 0.36 % at 0.057, 0.49 % at 0.067), or what angles make of it (third_order_share).
constexpr double worth_a_look = 0.02;

/// Ends of windows [s]: outputs of the run, so that a change of rungs is one.
std::vector<double> window_ends(double start, double end, double output, std::size_t most) {
  std::vector<double> ends;
  const double outputs = (end - start) / output;
  const auto windows = static_cast<double>(std::clamp<std::size_t>(static_cast<std::size_t>(outputs), 1, most));
  for (double k = 1; k < windows; ++k) {
    const double t = std::round((start + (end - start) * k / windows) / output) * output;
    if (t > (ends.empty() ? start : ends.back()) && t < end - 1e-6 * output) ends.push_back(t);
  }
  ends.push_back(end);
  return ends;
}

/// What a coarse run takes over the first two windows; the first one has its first steps.
struct Beginning {
  std::size_t first = 0, second = 0;  ///< evaluations
  bool reached = false;
};

/// `imex`, which modes do not limit (`dopri5` for equations that have no such way), or `radau` where stiff loads make
/// it the cheaper one over the second window, in the least rung. \param per_window evaluations of the one chosen
std::string cheapest_integrator(const Prepared& prepared, Registry& registry, const Outputs& outputs, double tolerance,
                                const State& start, const std::vector<double>& ends, std::size_t& per_window,
                                std::vector<std::size_t>& evaluations) {
  const auto begin = [&](const char* id, std::size_t most_first, std::size_t most_second) {
    const auto integrator = make_integrator(registry, id, tolerance);
    const double until = ends[std::min<std::size_t>(1, ends.size() - 1)];
    CoarseRun run(prepared, 0, 0, outputs, *integrator, start, until);
    Beginning b;
    b.reached = run.to(ends.front(), {}, most_first);
    b.first = run.evaluations();
    b.reached = b.reached && run.to(until, {}, b.first + most_second);
    b.second = ends.size() > 1 ? run.evaluations() - b.first : b.first;
    run.charge(evaluations);
    return b;
  };
  constexpr std::size_t any = 1'000'000'000;
  const bool implicit = prepared.rungs.front().equations->linearly_implicit() != nullptr;
  const char* usual = implicit ? "imex" : "dopri5";
  const Beginning of_usual = begin(usual, any, any);
  per_window = of_usual.second;
  const auto part = [](std::size_t n) { return static_cast<std::size_t>(static_cast<double>(n) / radau_weight); };
  const Beginning of_radau = begin("radau", part(of_usual.first + of_usual.second), part(of_usual.second));
  if (of_usual.reached && (!of_radau.reached || of_radau.second >= part(of_usual.second))) return usual;
  if (of_radau.reached) per_window = of_radau.second;
  return of_radau.reached ? "radau" : usual;
}

/// What is to be known of readings as they come.
class Extremes {
 public:
  Extremes(const Outputs& outputs, ReferenceTrack& track, std::vector<double> first)
      : outputs_(outputs), track_(track), first_(std::move(first)) {
    raise(first_);
  }
  void raise(const std::vector<double>& values) { outputs_.raise(values, first_, track_.ranges); }

 private:
  const Outputs& outputs_;
  ReferenceTrack& track_;
  std::vector<double> first_;
};

/// Whether what went along is too far off to go on with, by the ranges so far.
bool far_off(const Outputs& outputs, const ReferenceTrack& track, const Distances& errors, double accuracy) {
  constexpr double far = 3;
  const Distances limits = Accuracy{accuracy, {}, {}}.limits(outputs, scales(outputs, track.ranges, track.energy));
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > far * limits[i]) return true;
  return false;
}

}  // namespace

ReferenceTracker::ReferenceTracker(const Prepared& prepared, Registry& registry, const Outputs& outputs,
                                   double accuracy, const Control& control, std::vector<std::size_t>& evaluations)
    : prepared_(prepared),
      registry_(registry),
      outputs_(outputs),
      accuracy_(accuracy),
      control_(control),
      evaluations_(evaluations),
      tolerance_(std::clamp(accuracy, 1e-7, loosest)),
      start_(begun(prepared.model(), *prepared.rungs.front().equations, prepared.scene.initial)),
      end_(end_of_run(prepared.scene)),
      ends_(window_ends(start_.time, end_, prepared.scene.output, most_windows)),
      integrator_(
          cheapest_integrator(prepared, registry, outputs, tolerance_, start_, ends_, per_window_, evaluations)) {
  const std::size_t over_the_run = per_window_ * ends_.size();
  ends_ = window_ends(start_.time, end_, prepared.scene.output,
                      std::clamp(over_the_run / worth_a_window, least_windows, most_windows));
  per_window_ = over_the_run / ends_.size();
  const bool exact = prepared.rungs.back().terms.strain == StrainOrder::exact;
  second_ = prepared.rungs.size() - (exact ? 2 : 1);
  small_ = exact ? std::sqrt(worth_a_look * accuracy) : std::numeric_limits<double>::infinity();
}

ReferenceTrack ReferenceTracker::blank() const {
  ReferenceTrack track;
  track.rung = track.low = second_;
  track.integrator = integrator_;
  track.tolerance = tolerance_;
  track.start = start_;
  track.end = end_;
  track.ranges = outputs_.none();
  return track;
}

/// False where bodies bend beyond a limit, or what goes along beside is far off.
bool ReferenceTracker::run(ReferenceTrack& track, double most_bend, bool beside) {
  const auto integrator = make_integrator(registry_, integrator_, tolerance_);
  const auto following = make_integrator(registry_, integrator_, std::min(looser * tolerance_, 1.0));
  CoarseRun run(prepared_, track.low, track.rung, outputs_, *integrator, start_, end_);
  CoarseRun least(prepared_, 0, 0, outputs_, *following, start_, end_);
  Extremes extremes(outputs_, track, run.read());
  ThirdOrder third_order(prepared_);
  third_order.look(start_);
  const auto look = [&](const State& s) { third_order.look(s); };
  Distances errors = outputs_.none();
  bool good = true;
  for (std::size_t k = 0; good && k < ends_.size(); ++k) {
    if (beside && (k + 1) % together() != 0 && k + 1 < ends_.size()) continue;
    WindowTrack window;
    const std::size_t most = beside && track.low != track.rung ? too_many(track.windows.size())
                                                               : std::numeric_limits<std::size_t>::max() / 2;
    const bool reached = run.track(ends_[k], control_, (end_ - start_.time) / readings, most, look, window);
    for (const std::vector<double>& values : window.readings)
      if (!values.empty()) extremes.raise(values);
    track.bend = third_order.bend();
    track.energy = std::max(track.energy, run.kinetic_energy());
    if (!reached) {
      track.problem = control_.stop() ? "interrupted" : "it cannot go on";
      break;
    }
    track.windows.push_back(std::move(window));
    good = !(track.bend.size() > most_bend);
    if (!good || !beside) continue;
    WindowTrack along;
    good = least.follow(track.windows.back(), control_, along);
    for (std::size_t i = 0; good && i < along.readings.size(); ++i)
      if (!along.readings[i].empty()) outputs_.raise(along.readings[i], track.windows.back().readings[i], errors);
    good = good && !far_off(outputs_, track, errors, accuracy_);
    track.beside.push_back(std::move(along));
  }
  run.charge(evaluations_);
  least.charge(evaluations_);
  return good && track.problem.empty();
}

std::size_t ReferenceTracker::together() const { return std::max<std::size_t>(ends_.size() / comparisons, 1); }

std::size_t ReferenceTracker::too_many(std::size_t windows_done) const {
  constexpr std::size_t shorter = 2, at_first = 100;
  return shorter * together() * per_window_ + (windows_done == 0 ? at_first : 0);
}

/// Where `exact` is offered it would have been taken for more than a fiftieth of the accuracy.
double ReferenceTracker::lacking(const Bend& bend) const {
  return std::isinf(small_) ? third_order_over_a_run(bend) : third_order_share(bend);
}

ReferenceTrack ReferenceTracker::beside_least() {
  ReferenceTrack track = blank();
  if (second_ == 0) return track;
  const auto made = [&](std::size_t low) {
    track = blank();
    track.low = low;
    const bool good = run(track, small_, true);
    if (!good) track.beside.clear();
    seen_ = std::max(seen_, track.bend.size());
    track.third_order = lacking(track.bend);
    return good;
  };
  // Where only the correction failed, the reference is made in its own rung.
  if (corrects() && (made(0) || track.problem.empty() || control_.stop())) return track;
  made(second_);
  return track;
}

ReferenceTrack ReferenceTracker::highest() {
  ReferenceTrack track = blank();
  const bool exact = !std::isinf(small_);
  // What second order breaks down in need not be the motion: where there is an exact rung, that has the last word.
  if (!(seen_ > small_) && (run(track, small_, false) || (!track.problem.empty() && (!exact || control_.stop())))) {
    track.third_order = lacking(track.bend);
    return track;
  }
  const auto made = [&](std::size_t low) {
    track = blank();
    track.rung = prepared_.rungs.size() - 1;
    track.low = low;
    run(track, std::numeric_limits<double>::infinity(), false);
    return track.problem.empty();
  };
  // Where only the correction failed, the reference is made in its own rung.
  if (corrects() && (made(second_) || control_.stop())) return track;
  made(prepared_.rungs.size() - 1);
  return track;
}

}  // namespace withy::study
